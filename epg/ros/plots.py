# SPDX-License-Identifier: Apache-2.0
"""The plots of a target: the values of its topics that a person wants to see in one diagram.

A setpoint and the measured values of the same axis are one plot.  They have the same unit, and a word of their names in
common that other setpoints do not have: ``setpoint_pan``, ``pan_publisher``.  The names are those of the component, of
its port and of the model's port.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence

from epg.dataclass import dataclass
from epg.ros.messages import SCALARS, fields_of, library_of
from epg.ros.robot import Robot, RobotTopic


@dataclass(frozen=True)
class Series:
    """One value of a topic.

    ``topic`` is the full name, ``path`` the way to the value in the message: ("position", 0).  ``joint`` is its joint,
    if the message names joints.  ``stamped`` is True if the message has a header.
    """

    topic: str
    path: tuple[str | int, ...]
    joint: str
    stamped: bool
    label: str
    unit: str
    words: frozenset[str]


@dataclass(frozen=True)
class Plot:
    """A diagram.  ``setpoint`` belongs to the first of the ``measured`` values; it can be None."""

    title: str
    setpoint: Series | None
    measured: tuple[Series, ...]

    @property
    def series(self) -> tuple[Series, ...]:
        return ((self.setpoint,) if self.setpoint else ()) + self.measured


def plots_of(robot: Robot) -> list[Plot]:
    """The plots of a target: those of the setpoints in their order, then the other values, by unit."""
    setpoints = _series(robot, robot.subscriptions)
    special = _special_words(setpoints)
    belonging: list[list[Series]] = [[] for _ in setpoints]
    others: dict[str, list[Series]] = {}
    for one in _series(robot, robot.publications):
        scores = [len(one.words & words) if s.unit == one.unit else 0 for s, words in zip(setpoints, special)]
        if max(scores, default=0) > 0:
            belonging[scores.index(max(scores))].append(one)
        else:
            others.setdefault(one.unit or one.topic, []).append(one)
    groups = [*zip(setpoints, belonging), *((None, found) for found in others.values())]
    return [Plot(_title(([s] if s else []) + found), s, tuple(found)) for s, found in groups]


def _series(robot: Robot, topics: Iterable[RobotTopic]) -> list[Series]:
    result = []
    for topic in topics:
        if topic.role != "values":
            continue
        for value, field in zip(topic.values, fields_of(topic)):
            path, joint = _place(topic, field)
            wire = robot.wires.get((topic.component, field or topic.elements[0]))
            port, unit = wire or ("", "")
            words = frozenset(word for name in (topic.component, field, port) for word in _words(name))
            result.append(Series(robot.topic(topic), path, joint, _is_stamped(robot, topic.type), value, unit, words))
    return result


def _place(topic: RobotTopic, field: str) -> tuple[tuple[str | int, ...], str]:
    """The path to a value in its message, and its joint."""
    if topic.type in SCALARS:
        return ("data",), ""
    if topic.type == "std_msgs/msg/Float64MultiArray":
        return ("data", topic.elements.index(field)), ""
    if topic.type == "sensor_msgs/msg/JointState":
        joint, _, quantity = field.rpartition(".")
        joints = list(dict.fromkeys(element.rpartition(".")[0] for element in topic.elements))
        return (quantity, joints.index(joint)), joint
    if topic.type in ("geometry_msgs/msg/Twist", "geometry_msgs/msg/TwistStamped"):
        vector, _, axis = field.partition("_")
        return (*(["twist"] if topic.type.endswith("Stamped") else []), vector, axis), ""
    return tuple(int(part) if part.isdigit() else part for part in field.split(".")), ""


def _is_stamped(robot: Robot, type_: str) -> bool:
    """True if the message has a header."""
    library = library_of(robot, type_)
    return library is not None and any(f.name == "header" for f in library[type_].fields)


def _special_words(setpoints: Sequence[Series]) -> list[frozenset[str]]:
    """For each setpoint, the words of its names that not all setpoints with its unit have."""
    result = []
    for one in setpoints:
        alike = [other.words for other in setpoints if other.unit == one.unit]
        common = frozenset.intersection(*alike) if len(alike) > 1 else frozenset()
        result.append(one.words - common)
    return result


def _words(name: str) -> list[str]:
    return [word.lower() for word in re.findall(r"[A-Z]?[a-z]+|[A-Z]+|\d+", name)]


def _title(series: Sequence[Series]) -> str:
    """The words that all series have, otherwise their names; and the unit."""
    common = frozenset.intersection(*(one.words for one in series))
    named = " ".join(dict.fromkeys(word for word in _words(series[0].label) if word in common))
    title = named if named and len(series) > 1 else ", ".join(dict.fromkeys(one.label for one in series))
    return f"{title} [{series[0].unit}]" if series[0].unit else title
