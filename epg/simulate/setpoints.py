# SPDX-License-Identifier: Apache-2.0
"""Turns a scenario into the file of setpoints that a host executable reads, with rows of time, topic and value."""

from __future__ import annotations

import math
from collections.abc import Mapping
from fractions import Fraction
from pathlib import Path

from epg.simulate.scenario import FAILURES, Event, Scenario

Row = tuple[Fraction, str, "float | str"]


def setpoint_rows(
    scenario: Scenario, *, realtime: bool = False, target: str = "", topics: Mapping[str, str] | None = None
) -> list[Row]:
    """All rows for a target, in the order of time.  With ``realtime``, stalls are left out: they need simulated time.

    ``topics`` are the topics of the target in a system: their names in the scenario and their own names.
    """
    rows: list[Row] = []
    names = {topic: topic for topic in scenario.profiles} if topics is None else topics
    events = [event for event in scenario.events if event.target in ("", target)]
    for topic, profile in sorted(scenario.profiles.items()):
        if topic not in names:
            continue
        gaps = [event for event in events if event.kind == "lost" and event.topic in ("", topic)]
        for number in range(math.ceil(scenario.duration / scenario.interval)):
            time = number * scenario.interval
            if not any(gap.at <= time < gap.at + gap.duration for gap in gaps):
                rows.append((time, names[topic], profile.value(float(time))))
    rows += [row for event in events for row in _event_rows(event, realtime, target, names)]
    return sorted(rows, key=lambda row: (row[0], not row[1].startswith("$"), row[1]))


def _event_rows(event: Event, realtime: bool, target: str, topics: Mapping[str, str]) -> list[Row]:
    """The rows of one event.  Names that begin with ``$`` are commands to the host platform."""
    if event.kind in ("enable", "disable"):
        return [(event.at, "$enable", float(event.kind == "enable"))]
    if event.kind == "setpoint" and event.topic in topics:
        return [(event.at, topics[event.topic], event.value)]
    if event.kind == "stall" and not realtime:
        return [(event.at, "$stall", float(event.duration))]
    if event.kind == "component":
        owner, _, name = event.component.rpartition("/")
        return [(event.at, f"$component:{name}", event.level)] if owner == target else []
    return []


def failure_lines(scenario: Scenario) -> list[str]:
    """The lines of the file of failures of a system's targets, in the order of time."""
    failures = sorted((event for event in scenario.events if event.kind in FAILURES), key=lambda event: event.at)
    return ["time,target,event", *(f"{float(event.at)!r},{event.target},{event.kind}" for event in failures)]


def write_setpoints(rows: list[Row], path: Path) -> None:
    """Writes the rows into ``path``.  Numbers have as few digits as possible for reading the same double again."""
    shown = ((time, topic, value if isinstance(value, str) else repr(value)) for time, topic, value in rows)
    lines = ["time,topic,value\n", *(f"{float(time)!r},{topic},{value}\n" for time, topic, value in shown)]
    path.write_text("".join(lines), encoding="utf-8", newline="\n")
