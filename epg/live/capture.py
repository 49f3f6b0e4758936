# SPDX-License-Identifier: Apache-2.0
"""Recordings of every control cycle, which the target makes in its memory around a trigger (the command ``capture``).

>>> progress_of("ok capture state=ready rows=200 trigger=50")
CaptureProgress(recording=False, rows=200, trigger=50)
>>> found = recorded_of(["csv time,outputs.a", "csv 7.5,1", "csv 7.75,2", "ok capture"], 1)
>>> found.names, [(row.time, row.values) for row in found.rows]
(('outputs.a',), [(-0.25, [1.0]), (0.0, [2.0])])
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

from epg.live.client import words_of
from epg.runs.recording import Row


class CaptureProgress(NamedTuple):
    """The progress of a recording.  ``trigger`` is the row of the trigger; None: it has not happened."""

    recording: bool
    rows: int
    trigger: int | None


class Capture(NamedTuple):
    """A recording.  Its time 0 is the trigger; without one, the first row."""

    names: tuple[str, ...]
    rows: list[Row]
    triggered: bool


def progress_of(line: str) -> CaptureProgress:
    """The progress in the answer of the command ``capture``."""
    words = dict(words_of(line))
    trigger = words.get("trigger")
    return CaptureProgress(
        words["state"] == "recording", int(words["rows"]), int(trigger) if trigger is not None else None
    )


def recorded_of(lines: Sequence[str], trigger: int | None) -> Capture:
    """The recording in the answer of the command ``capture read``."""
    header, *rows = (line.removeprefix("csv ").split(",") for line in lines if line.startswith("csv "))
    numbers = [[float(text) for text in row] for row in rows]
    begin = numbers[trigger or 0][0] if numbers else 0.0
    found = [Row(round(time - begin, 9), values) for time, *values in numbers]
    return Capture(tuple(header[1:]), found, trigger is not None)
