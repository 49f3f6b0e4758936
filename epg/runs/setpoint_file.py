# SPDX-License-Identifier: Apache-2.0
"""Turns a scenario into the file of setpoints that a host executable reads, with rows of time, topic and value."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from fractions import Fraction
from pathlib import Path

from epg.runs.csv_file import CsvFile
from epg.runs.recording import ROWS, Row
from epg.runs.scenario import FAILURES, Event, Scenario

SetpointRow = tuple[Fraction, str, "float | str"]


def setpoint_rows(
    scenario: Scenario, *, realtime: bool = False, target: str = "", topics: Mapping[str, str] | None = None
) -> list[SetpointRow]:
    """All rows for a target, in the order of time.  With ``realtime``, stalls are left out: they need simulated time.

    ``topics`` are the topics of the target in a system: their names in the scenario and their own names.
    """
    rows: list[SetpointRow] = []
    names = {topic: topic for topic in scenario.profiles} if topics is None else topics
    events = [event for event in scenario.events if event.target in ("", target)]
    for topic, profile in sorted(scenario.profiles.items()):
        if topic not in names:
            continue
        rows += [(time, names[topic], profile.value(float(time))) for time in _times(scenario, topic, events)]
    rows += [row for event in events for row in _event_rows(event, realtime, target, names)]
    return sorted(rows, key=lambda row: (row[0], not row[1].startswith("$"), row[1]))


def _times(scenario: Scenario, topic: str, events: Sequence[Event]) -> Iterator[Fraction]:
    """The times at which the setpoint ``topic`` is sent: those at which no event loses it."""
    gaps = [event for event in events if event.kind == "lost" and event.topic in ("", topic)]
    for number in range(math.ceil(scenario.duration / scenario.interval)):
        time = number * scenario.interval
        if not any(gap.at <= time < gap.at + gap.duration for gap in gaps):
            yield time


def _event_rows(event: Event, realtime: bool, target: str, topics: Mapping[str, str]) -> list[SetpointRow]:
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


def write_setpoints(rows: list[SetpointRow], path: Path) -> None:
    """Writes the rows into ``path``.  Numbers have as few digits as possible for reading the same double again."""
    with CsvFile(path, ROWS[1:], "%s", "%s") as file:
        file.write(Row(float(time), (topic, value)) for time, topic, value in rows)
