# SPDX-License-Identifier: Apache-2.0
"""A scenario as data: setpoint profiles, events, and what is evaluated.  Times in s, values in the topic's unit.

>>> profile = Profile(0.0, (Part("move", start=1.0, duration=2.0, target=1.0),))
>>> [round(profile.value(t), 3) for t in (0.0, 1.0, 2.0, 3.0, 9.0)]
[0.0, 0.0, 0.5, 1.0, 1.0]
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path

from epg.source import Span


@dataclass(frozen=True)
class Part:
    """One part of a profile.  ``target`` is absolute for move, ramp and step, relative for raised_cosine and sine."""

    shape: str
    start: float
    duration: float
    target: float
    frequency: float = 0.0

    @property
    def end(self) -> float:
        return self.start + self.duration

    def value(self, time: float, before: float) -> float:
        """Value at ``time`` (at or after the start) of a part that began at the value ``before``."""
        if time >= self.end:
            return before if self.shape in ("raised_cosine", "sine") else self.target
        share = (time - self.start) / self.duration
        if self.shape == "raised_cosine":
            return before + self.target * (1 - math.cos(2 * math.pi * share)) / 2
        if self.shape == "sine":
            return before + self.target * math.sin(2 * math.pi * self.frequency * (time - self.start))
        rise = share if self.shape == "ramp" else (1 - math.cos(math.pi * share)) / 2
        return before + (self.target - before) * rise


@dataclass(frozen=True)
class Profile:
    """A setpoint over time: parts in order, held in between."""

    initial: float
    parts: tuple[Part, ...]

    @property
    def span(self) -> tuple[float, float] | None:
        """Start of the first and end of the last part."""
        return (self.parts[0].start, self.parts[-1].end) if self.parts else None

    def value(self, time: float) -> float:
        value = self.initial
        for part in self.parts:
            if time < part.start:
                break
            value = part.value(time, value)
        return value


@dataclass(frozen=True)
class Event:
    """``kind``: enable, disable, setpoint, lost, stall or component.

    ``topic`` empty: all.  ``duration`` of lost and stall.  ``level`` of ``component``: "0", "1", "open" or "plant".
    """

    at: Fraction
    kind: str
    topic: str = ""
    value: float = 0.0
    duration: Fraction = Fraction(0)
    component: str = ""
    level: str = ""


@dataclass(frozen=True)
class Window:
    """A stretch of time in which the tracking error is evaluated; a limit of None holds always."""

    start: float
    end: float
    rms: float | None = None
    largest: float | None = None


@dataclass(frozen=True)
class Homing:
    until: float
    duty: float | None = None
    position: float | None = None


@dataclass(frozen=True)
class Axis:
    """What is evaluated: signal ``position`` against the profile of topic ``setpoint``.

    ``signals`` are all signals of the axis.
    """

    name: str
    setpoint: str
    position: str
    duty: str | None
    unit: str
    homing: Homing | None
    windows: tuple[Window, ...]
    signals: tuple[str, ...]


@dataclass(frozen=True)
class Scenario:
    """``ends``: enabled, disabled or never_enabled.  ``names`` are all that only the target can know: what is named,
    and where: a "topic", an "input" or a "signal".
    """

    path: Path
    duration: Fraction
    interval: Fraction
    reference: Path | None
    profiles: dict[str, Profile]
    events: tuple[Event, ...]
    axes: tuple[Axis, ...]
    ends: str = "enabled"
    names: tuple[tuple[str, str, Span], ...] = ()
