# SPDX-License-Identifier: Apache-2.0
"""Turns a scenario into the file of setpoints that a host executable reads, with rows of time, topic and value."""

from __future__ import annotations

import math
from fractions import Fraction
from pathlib import Path

from epg.simulate.scenario import Event, Scenario

Row = tuple[Fraction, str, "float | str"]


def setpoint_rows(scenario: Scenario, *, realtime: bool = False) -> list[Row]:
    """All rows, in the order of time.  With ``realtime``, stalls are left out: they need simulated time."""
    rows: list[Row] = []
    for topic, profile in sorted(scenario.profiles.items()):
        gaps = [event for event in scenario.events if event.kind == "lost" and event.topic in ("", topic)]
        for number in range(math.ceil(scenario.duration / scenario.interval)):
            time = number * scenario.interval
            if not any(gap.at <= time < gap.at + gap.duration for gap in gaps):
                rows.append((time, topic, profile.value(float(time))))
    rows += [row for event in scenario.events for row in _event_rows(event, realtime)]
    return sorted(rows, key=lambda row: (row[0], not row[1].startswith("$"), row[1]))


def _event_rows(event: Event, realtime: bool) -> list[Row]:
    """The rows of one event.  Names that begin with ``$`` are commands to the host platform."""
    if event.kind in ("enable", "disable"):
        return [(event.at, "$enable", float(event.kind == "enable"))]
    if event.kind == "setpoint":
        return [(event.at, event.topic, event.value)]
    if event.kind == "stall" and not realtime:
        return [(event.at, "$stall", float(event.duration))]
    if event.kind == "component":
        return [(event.at, f"$component:{event.component}", event.level)]
    return []


def write_setpoints(rows: list[Row], path: Path) -> None:
    """Writes the rows into ``path``.  Numbers have as few digits as possible for reading the same double again."""
    shown = ((time, topic, value if isinstance(value, str) else repr(value)) for time, topic, value in rows)
    lines = ["time,topic,value\n", *(f"{float(time)!r},{topic},{value}\n" for time, topic, value in shown)]
    path.write_text("".join(lines), encoding="utf-8", newline="\n")
