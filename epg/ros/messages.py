# SPDX-License-Identifier: Apache-2.0
"""Messages as numbers: the values a target's topic carries, in the order of its ports.

Works on any object with the fields of the message, so on those of CycloneDDS and of rclpy alike.

>>> from types import SimpleNamespace as Message
>>> topic = Topic("joints", "sensor_msgs/msg/JointState", "reliable", "values", ("joints/pan.position",), ())
>>> numbers(topic, Message(name=["tilt", "pan"], position=[2.0, 1.0], velocity=[], effort=[]))
[1.0]
"""

from __future__ import annotations

from typing import Any

from epg.ros.robot import Topic

SCALARS = ("std_msgs/msg/Float64", "std_msgs/msg/Float32", "std_msgs/msg/Int32", "std_msgs/msg/Bool")
TYPES = (
    *SCALARS,
    "std_msgs/msg/Float64MultiArray",
    "sensor_msgs/msg/JointState",
    "geometry_msgs/msg/Twist",
    "geometry_msgs/msg/TwistStamped",
)
"""The types that can be recorded."""


def numbers(topic: Topic, message: Any) -> list[float | None]:
    """One number for each of ``topic.values``; None where the message has none."""
    if topic.type in SCALARS:
        return [float(message.data)]
    fields = fields_of(topic)
    if topic.type == "std_msgs/msg/Float64MultiArray":
        return [_element(message, topic.elements.index(field)) for field in fields]
    if topic.type == "sensor_msgs/msg/JointState":
        return [_joint(message, field) for field in fields]
    twist = message.twist if topic.type == "geometry_msgs/msg/TwistStamped" else message
    return [_component(twist, field) for field in fields]


def fields_of(topic: Topic) -> list[str]:
    """What ``topic.values`` name within the message: ``joints/pan.position`` is ``pan.position`` of ``joints``."""
    return [value.removeprefix(topic.name).removeprefix("/") for value in topic.values]


def _element(message: Any, index: int) -> float | None:
    position = message.layout.data_offset + index
    return float(message.data[position]) if position < len(message.data) else None


def _joint(message: Any, field: str) -> float | None:
    joint, _, quantity = field.rpartition(".")
    try:
        return float(getattr(message, quantity)[list(message.name).index(joint)])
    except (ValueError, IndexError):
        return None


def _component(twist: Any, field: str) -> float:
    vector, _, axis = field.partition("_")
    return float(getattr(getattr(twist, vector), axis))
