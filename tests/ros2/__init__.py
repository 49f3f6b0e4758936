# SPDX-License-Identifier: Apache-2.0
"""A peer in Python that looks like a ROS 2 node, and what is tested with it."""
