# SPDX-License-Identifier: Apache-2.0
"""Where messages come from: DDS itself, or rclpy where ROS 2 is sourced."""

from __future__ import annotations

import importlib.util
from collections.abc import Sequence

from epg.ros.source import Source, Subscription


def open_source(way: str | None, subscriptions: Sequence[Subscription], domain: int) -> Source:
    """``way`` is "dds", "rclpy" or None: CycloneDDS where it is installed, else rclpy where ROS 2 is sourced.

    Raises :class:`epg.bootstrap.MissingPackages`.
    """
    from epg import bootstrap

    if way == "rclpy" or (way is None and not _has("cyclonedds") and _has("rclpy")):
        from epg.ros.rclpy_source import RclpySource

        return RclpySource(subscriptions, domain)
    bootstrap.ensure("ros")
    from epg.ros.dds_source import DdsSource

    return DdsSource(subscriptions, domain)


def _has(module: str) -> bool:
    return importlib.util.find_spec(module) is not None
