# SPDX-License-Identifier: Apache-2.0
"""Receives messages by rclpy, in a shell in which ROS 2 is sourced, through the middleware that ROS 2 is set to."""

from __future__ import annotations

import time
from collections.abc import Sequence
from functools import partial
from typing import Any

import rclpy
from rclpy.context import Context
from rclpy.executors import SingleThreadedExecutor
from rclpy.qos import QoSProfile, ReliabilityPolicy
from rclpy.serialization import deserialize_message
from rosidl_runtime_py.utilities import get_message

from epg.generator.bootstrap import MissingPackages
from epg.ros.message_source import Sample, Subscription

_DEPTH = 256


class RclpySource:
    """See :class:`epg.ros.message_source.MessageSource`.

    Raises :class:`epg.generator.bootstrap.MissingPackages` for an unknown message.
    """

    def __init__(self, subscriptions: Sequence[Subscription], domain: int) -> None:
        self._context = Context()
        self._context.init(domain_id=domain)
        self._node = rclpy.create_node("epg_record", context=self._context)
        self._executor = SingleThreadedExecutor(context=self._context)
        self._executor.add_node(self._node)
        self._samples: list[Sample] = []
        self._types = [_class(subscription.type) for subscription in subscriptions]
        self._names = [subscription.name for subscription in subscriptions]
        for number, subscription in enumerate(subscriptions):
            reliability = ReliabilityPolicy.RELIABLE if subscription.reliable else ReliabilityPolicy.BEST_EFFORT
            self._node.create_subscription(
                self._types[number],
                subscription.name,
                partial(self._arrived, number),
                QoSProfile(depth=_DEPTH, reliability=reliability),
                raw=True,
            )

    def _arrived(self, subscription: int, data: bytes, info: dict[str, Any]) -> None:
        message = deserialize_message(data, self._types[subscription])
        published = info.get("source_timestamp", 0)
        self._samples.append(Sample(time.monotonic_ns(), subscription, message, published, lambda: data))

    def take(self, seconds: float) -> list[Sample]:
        self._executor.spin_once(timeout_sec=seconds)
        taken, self._samples = self._samples, []
        return taken

    def publishers(self) -> list[int]:
        return [self._node.count_publishers(name) for name in self._names]

    def close(self) -> None:
        self._node.destroy_node()
        self._context.try_shutdown()


def _class(type_: str) -> Any:
    try:
        return get_message(type_)
    except (AttributeError, LookupError, ModuleNotFoundError, ValueError):
        remedy = "source the workspace with its package, or add --through dds"
        raise MissingPackages(f"ROS 2 does not have the message {type_}\nhint: {remedy}") from None
