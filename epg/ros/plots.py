# SPDX-License-Identifier: Apache-2.0
"""The plots of a target: the values of its topics that a person wants to see in one diagram.

A setpoint and the measured values of the same axis are one plot.  They have the same unit, and a word of their names in
common that other setpoints do not have: ``setpoint_pan``, ``pan_publisher``.  The names are those of the component, of
its port and of the model's port.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from epg.generator.correction import short
from epg.generator.dataclass import dataclass
from epg.ros.messages import SCALARS, library_of
from epg.runs.panels import words_in
from epg.runs.robot import DamagedDescription, Robot, RobotTopic


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
    """The plots of a target: those of the setpoints in their order, then the other values, by unit.

    Raises DamagedDescription if a message does not have a value of its topic.
    """
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
    groups = [*zip(setpoints, belonging), *((None, names) for names in others.values())]
    return [Plot(_title(([s] if s else []) + names), s, tuple(names)) for s, names in groups]


def _series(robot: Robot, topics: Iterable[RobotTopic]) -> list[Series]:
    result = []
    for topic in topics:
        if topic.role != "values":
            continue
        for value, field in zip(topic.values, topic.fields):
            path, joint = _place(topic, field)
            wire = robot.wires.get((topic.component, field or topic.elements[0]))
            port, unit = wire or ("", "")
            words = frozenset(word for name in (topic.component, field, port) for word in words_in(name))
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
        if joint not in joints:
            raise DamagedDescription(f"the elements of the topic '{topic.name}' have no joint '{short(joint)}'")
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


def _title(series: Sequence[Series]) -> str:
    """The words that all series have, otherwise their names; and the unit."""
    common = frozenset.intersection(*(one.words for one in series))
    named = " ".join(dict.fromkeys(word for word in words_in(series[0].label) if word in common))
    title = named if named and len(series) > 1 else ", ".join(dict.fromkeys(one.label for one in series))
    return f"{title} [{series[0].unit}]" if series[0].unit else title
