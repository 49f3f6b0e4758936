# SPDX-License-Identifier: Apache-2.0
"""A peer in Python that behaves like a ROS 2 node, and the tests that use it."""
