# SPDX-License-Identifier: Apache-2.0
"""A generated target as ROS 2 sees it: its topics, the agents it needs, recordings of what it does.

Works on descriptions (``<name>.json``), not on the files they were generated from: a robot in the field is recorded and
launched by whoever has its description.
"""
