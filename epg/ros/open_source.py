# SPDX-License-Identifier: Apache-2.0
"""Chooses the library that receives messages: CycloneDDS, or rclpy in a shell in which ROS 2 is sourced."""

from __future__ import annotations

import importlib.util
from collections.abc import Sequence

from epg.ros.message_source import MessageSource, Subscription


def open_source(way: str | None, subscriptions: Sequence[Subscription], domain: int) -> MessageSource:
    """Subscribes to topics in the ROS ``domain``.

    ``way`` is "dds", "rclpy" or None.  With None, CycloneDDS is used if it is installed.  If it is not, rclpy is used
    if ROS 2 is sourced; otherwise EPG installs CycloneDDS into its cache.  Raises
    :class:`epg.generator.bootstrap.MissingPackages` if that is not possible.
    """
    from epg.generator import bootstrap

    if way == "rclpy" or (way is None and not _has("cyclonedds") and _has("rclpy")):
        from epg.ros.rclpy_source import RclpySource

        return RclpySource(subscriptions, domain)
    bootstrap.ensure("ros")
    from epg.ros.dds_source import DdsSource

    return DdsSource(subscriptions, domain)


def _has(module: str) -> bool:
    return importlib.util.find_spec(module) is not None
