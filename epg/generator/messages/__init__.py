# SPDX-License-Identifier: Apache-2.0
"""Definitions of ROS 2 messages: ``.msg`` files, the hashes of types, and complete definitions for recordings.

EPG has the definitions that it needs in ``targets/messages``, in folders as those of ROS 2:
``<package>/msg/<Name>.msg``.
"""
