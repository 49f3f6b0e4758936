"""Where messages come from: DDS itself, or rclpy where ROS 2 is sourced."""

from __future__ import annotations

import importlib.util
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Protocol


@dataclass(frozen=True)
class Subscription:
    """A topic to listen to: its full ROS name, its type as in ``ros2 topic list -t``, whether reliably."""

    name: str
    type: str
    reliable: bool


@dataclass(frozen=True)
class Sample:
    """A message of subscription number ``subscription`` that arrived at ``time_ns`` of the monotonic clock."""

    time_ns: int
    subscription: int
    message: Any


class Source(Protocol):
    """Something that is subscribed to topics."""

    def take(self, seconds: float) -> list[Sample]:
        """What has arrived since the last call, waiting up to ``seconds`` for something to arrive."""

    def publishers(self) -> list[int]:
        """How many publishers each subscription has found; -1 if there is one whose QoS does not fit."""

    def close(self) -> None: ...


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
