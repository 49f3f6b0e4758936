# SPDX-License-Identifier: Apache-2.0
"""A scenario as data: setpoint profiles, events, and signals to evaluate.

Times are in seconds, values in the unit of their topic.  Values have the same bits on every system.

>>> profile = Profile(0.0, (ProfilePart("move", start=1.0, duration=2.0, target=1.0),))
>>> [round(profile.value(t), 3) for t in (0.0, 1.0, 2.0, 3.0, 9.0)]
[0.0, 0.0, 0.5, 1.0, 1.0]
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import field
from fractions import Fraction
from pathlib import Path
from types import MappingProxyType

from epg.generator.dataclass import dataclass
from epg.generator.source import Span
from epg.runs.sine import cosine, sine

FAILURES = ("die", "hang", "restart", "offline", "online")
"""The failures of a target of a system, and their ends."""


@dataclass(frozen=True)
class ProfilePart:
    """One part of a profile.

    ``target`` is an absolute value for move, ramp and step.  It is relative to the value before the part for
    raised_cosine and sine.
    """

    shape: str
    start: float
    duration: float
    target: float
    frequency: float = 0.0

    @property
    def end(self) -> float:
        return self.start + self.duration

    def value(self, time: float, before: float) -> float:
        """The value at ``time``, which must not be before the start.  ``before`` is the value at the start."""
        if time >= self.end:
            return before if self.shape in ("raised_cosine", "sine") else self.target
        share = (time - self.start) / self.duration
        if self.shape == "raised_cosine":
            return before + self.target * (1 - cosine(2 * math.pi * share)) / 2
        if self.shape == "sine":
            return before + self.target * sine(2 * math.pi * self.frequency * (time - self.start))
        rise = share if self.shape == "ramp" else (1 - cosine(math.pi * share)) / 2
        return before + (self.target - before) * rise


@dataclass(frozen=True)
class Profile:
    """A setpoint over time.  The parts are in order; between them the setpoint keeps its value."""

    initial: float
    parts: tuple[ProfilePart, ...]

    @property
    def span(self) -> tuple[float, float] | None:
        """The start of the first part and the end of the last part, or None if there are no parts."""
        return (self.parts[0].start, self.parts[-1].end) if self.parts else None

    def value(self, time: float) -> float:
        """The setpoint at ``time``."""
        value = self.initial
        for part in self.parts:
            if time < part.start:
                break
            value = part.value(time, value)
        return value


@dataclass(frozen=True)
class Event:
    """An event.  ``kind`` is enable, disable, setpoint, lost, stall, component, or a failure: :data:`FAILURES`.

    ``topic`` is the topic of setpoint and lost; for lost, empty means all topics.  ``value`` is the value of setpoint.
    ``duration`` belongs to lost and stall.  ``level`` belongs to component: "0", "1", "open" or "plant".  ``target`` is
    a target of a system; empty means all.
    """

    at: Fraction
    kind: str
    topic: str = ""
    value: float = 0.0
    duration: Fraction = Fraction(0)
    component: str = ""
    level: str = ""
    target: str = ""


@dataclass(frozen=True)
class Window:
    """A time window in which the tracking error is evaluated.  ``rms`` and ``largest`` are limits; None is no limit."""

    start: float
    end: float
    rms: float | None = None
    largest: float | None = None


@dataclass(frozen=True)
class Homing:
    """The limits of homing, which must end at the time ``until``.

    ``duty`` limits the duty during homing, ``position`` the distance from the setpoint at its end; None is no limit.
    """

    until: float
    duty: float | None = None
    position: float | None = None


@dataclass(frozen=True)
class Axis:
    """An axis to evaluate: the signal ``position`` is compared with the profile of the topic ``setpoint``.

    If ``follows_signal`` is true, ``setpoint`` is a signal, such as the position of another target.  ``duty`` is the
    signal that drives the motor, or None.  ``signals`` are all signals of the axis.
    """

    name: str
    setpoint: str
    position: str
    duty: str | None
    unit: str
    homing: Homing | None
    windows: tuple[Window, ...]
    signals: tuple[str, ...]
    follows_signal: bool = False


@dataclass(frozen=True)
class Scenario:
    """A scenario.  ``ends`` is the expected end of the run: enabled, disabled or never_enabled.

    ``ends_of`` are the expected ends of targets of a system that differ from ``ends``.  ``interval`` is the time
    between two setpoints.  ``names`` are the names that must be compared with those of the target or the system: the
    kind ("topic", "input", "signal" or "target"), the name, and its place in the file.  ``of_systems`` are the places
    of what only systems have.
    """

    path: Path
    duration: Fraction
    interval: Fraction
    reference: Path | None
    profiles: dict[str, Profile]
    events: tuple[Event, ...]
    axes: tuple[Axis, ...]
    ends: str = "enabled"
    ends_of: Mapping[str, str] = field(default_factory=lambda: MappingProxyType({}))
    names: tuple[tuple[str, str, Span], ...] = ()
    of_systems: tuple[Span, ...] = ()

    @property
    def signals(self) -> list[str]:
        """The signals of all axes."""
        return [signal for axis in self.axes for signal in axis.signals]
