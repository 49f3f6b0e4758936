"""Messages as numbers: the values a target's topic carries, in the order of its ports.

Works on any object with the fields of the message, so on those of CycloneDDS and of rclpy alike.

>>> from types import SimpleNamespace as Message
>>> numbers("std_msgs/msg/Bool", Message(data=True), [""])
[1.0]
>>> joints = Message(name=["tilt", "pan"], position=[2.0, 1.0], velocity=[], effort=[])
>>> numbers("sensor_msgs/msg/JointState", joints, ["pan.position", "pan.velocity"])
[1.0, None]
"""

from __future__ import annotations

from collections.abc import Sequence
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


def numbers(type: str, message: Any, fields: Sequence[str]) -> list[float | None]:
    """One number for each of ``fields``; None where the message has none."""
    if type in SCALARS:
        return [float(message.data)]
    if type == "std_msgs/msg/Float64MultiArray":
        data = list(message.data)
        return [float(data[i]) if i < len(data) else None for i in range(len(fields))]
    if type == "sensor_msgs/msg/JointState":
        return [_joint(message, field) for field in fields]
    twist = message.twist if type == "geometry_msgs/msg/TwistStamped" else message
    return [_component(twist, field) for field in fields]


def fields_of(topic: Topic) -> list[str]:
    """What ``topic.values`` name within the message: ``joints/pan.position`` is ``pan.position`` of ``joints``."""
    return [value.removeprefix(topic.name).removeprefix("/") for value in topic.values]


def _joint(message: Any, field: str) -> float | None:
    joint, _, quantity = field.rpartition(".")
    try:
        return float(getattr(message, quantity)[list(message.name).index(joint)])
    except (ValueError, IndexError):
        return None


def _component(twist: Any, field: str) -> float:
    vector, _, axis = field.partition(".")
    return float(getattr(getattr(twist, vector), axis))
