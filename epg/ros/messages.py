# SPDX-License-Identifier: Apache-2.0
"""Turns messages into numbers: the values of a target's topic, in the order of its ports.

The messages can be objects of CycloneDDS, of rclpy, or any other objects with the fields of the message.

>>> from types import SimpleNamespace as Message
>>> topic = RobotTopic("joints", "sensor_msgs/msg/JointState", "reliable", "values", ("joints/pan.position",), ())
>>> numbers(topic, Message(name=["tilt", "pan"], position=[2.0, 1.0], velocity=[], effort=[]))
[1.0]
"""

from __future__ import annotations

from typing import Any

from epg.generator.diagnostics import Diagnostics
from epg.generator.messages.library import Library, full_name
from epg.generator.source import Span
from epg.runs.robot import Robot, RobotTopic

SCALARS = ("std_msgs/msg/Float64", "std_msgs/msg/Float32", "std_msgs/msg/Int32", "std_msgs/msg/Bool")
TYPES = (
    *SCALARS,
    "std_msgs/msg/Float64MultiArray",
    "sensor_msgs/msg/JointState",
    "geometry_msgs/msg/Twist",
    "geometry_msgs/msg/TwistStamped",
)
"""The types of messages whose values have names other than those of their fields, or a single value."""


def library_of(robot: Robot, type_: str) -> Library | None:
    """A library with the message ``type_`` of a robot.  None if it is not known."""
    library = Library()
    if type_ in robot.messages:
        return library if full_name(type_) == type_ and library.add(type_, robot.messages[type_]) else None
    known = full_name(type_) == type_ and library.load(type_, Span(type_), Diagnostics()) is not None
    return library if known else None


def numbers(topic: RobotTopic, message: Any) -> list[float | None]:
    """One number for each item of ``topic.values``; None if the message does not contain that value."""
    if topic.type in SCALARS:
        return [float(message.data)]
    fields = topic.fields
    if topic.type == "std_msgs/msg/Float64MultiArray":
        return [_element(message, topic.elements.index(field)) for field in fields]
    if topic.type == "sensor_msgs/msg/JointState":
        return [_joint(message, field) for field in fields]
    if topic.type not in TYPES:
        return [_field(message, field) for field in fields]
    twist = message.twist if topic.type == "geometry_msgs/msg/TwistStamped" else message
    return [_component(twist, field) for field in fields]


def _element(message: Any, index: int) -> float | None:
    position = message.layout.data_offset + index
    return float(message.data[position]) if position < len(message.data) else None


def _joint(message: Any, field: str) -> float | None:
    joint, _, quantity = field.rpartition(".")
    try:
        return float(getattr(message, quantity)[list(message.name).index(joint)])
    except (ValueError, IndexError):
        return None


def _field(message: Any, path: str) -> float | None:
    """The number at a path such as ``angular_velocity.x`` or ``force.1``."""
    try:
        for part in path.split("."):
            message = message[int(part)] if part.isdigit() else getattr(message, part)
        return float(message)
    except (AttributeError, IndexError, TypeError, ValueError):
        return None


def _component(twist: Any, field: str) -> float:
    vector, _, axis = field.partition("_")
    return float(getattr(getattr(twist, vector), axis))
