# SPDX-License-Identifier: Apache-2.0
"""Tools for a generated target on a ROS 2 network: its topics, the agents that it needs, and recordings of its runs.

The tools read the description of a target (``<name>.json``) and not its source files.  A user who has only the
description can therefore record a robot and start its agents.
"""
