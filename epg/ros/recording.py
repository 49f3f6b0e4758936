# SPDX-License-Identifier: Apache-2.0
"""Reads recordings of real or simulated runs as signals over time.

Two formats are supported: rows of ``time,topic,value`` (``topics.csv``, ``setpoints.csv``), and tables with a column
``time`` and one column for each signal (``trace.csv``, ``tracking.csv``).  In a folder, ``topics.csv`` and
``setpoints.csv`` are read.
"""

from __future__ import annotations

import csv
import math
from array import array
from collections.abc import Iterator, Sequence
from pathlib import Path

from epg.dataclass import dataclass
from epg.diagnostics import Diagnostics
from epg.source import Span

_SETPOINTS = "setpoints.csv"
_FOLDER_FILES = (_SETPOINTS, "topics.csv")


@dataclass(frozen=True)
class Signal:
    """The values of a signal.  ``time`` is in seconds and never decreases."""

    time: Sequence[float]
    value: Sequence[float]


@dataclass(frozen=True)
class Recording:
    """All signals of a run by name.

    ``setpoints`` are the names of those that are known to be setpoints.  Events of the host platform, whose names begin
    with ``$``, are left out.
    """

    path: Path
    signals: dict[str, Signal]
    setpoints: frozenset[str]


def load_recording(path: Path, diagnostics: Diagnostics) -> Recording | None:
    """The recording in the file or folder ``path``.  None if it is wrong; the reason is reported."""
    files = [path]
    if path.is_dir():
        files = [path / name for name in _FOLDER_FILES if (path / name).is_file()]
        if not files:
            hint = f"the folder of a recording contains {' or '.join(_FOLDER_FILES)}"
            diagnostics.error("no-recording", Span(str(path)), "there is no recording here", hint=hint)
            return None
    columns: dict[str, tuple[array[float], array[float]]] = {}
    setpoints = set()
    before = diagnostics.error_count
    for file in files:
        for time, name, value in _rows(file, diagnostics):
            if file.name == _SETPOINTS:
                setpoints.add(name)
            times, values = columns.setdefault(name, (array("d"), array("d")))
            times.append(time)
            values.append(value)
    if diagnostics.error_count > before:
        return None
    signals = {name: Signal(*columns[name]) for name in columns if not name.startswith("$")}
    if not signals:
        diagnostics.error("no-recording", Span(str(path)), "this recording is empty")
        return None
    return Recording(path, signals, frozenset(setpoints & signals.keys()))


def _rows(file: Path, diagnostics: Diagnostics) -> Iterator[tuple[float, str, float]]:
    """The time, the signal and the value of each cell in ``file``.

    Cells that are empty, or whose values are not finite, are left out.
    """
    try:
        with file.open(encoding="utf-8", newline="") as text:
            rows = csv.reader(text)
            header = next(rows, [])
            if "time" not in header:
                message = "this is not a recording: its first line does not name a column 'time'"
                diagnostics.error("not-a-recording", Span(str(file), 1, 1, 2), message)
                return
            at = header.index("time")
            latest = -math.inf
            for number, row in enumerate(rows, start=2):
                if not row:
                    continue
                try:
                    time = float(row[at])
                    pairs = _cells(header, row, at)
                except (ValueError, IndexError):
                    message = "this line does not match the columns of the first line"
                    diagnostics.error("wrong-recording", Span(str(file), number, 1, 2), message)
                    return
                if not time >= latest:
                    message = f"the time decreases from {latest:g} s to {time:g} s"
                    diagnostics.error("wrong-recording", Span(str(file), number, 1, 2), message)
                    return
                latest = time
                yield from ((time, name, value) for name, value in pairs)
    except FileNotFoundError:
        diagnostics.error("file-not-found", Span(str(file)), f"there is no file '{file}'")
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        diagnostics.error("file-unreadable", Span(str(file)), f"cannot read '{file.name}': {error}")


def _cells(header: Sequence[str], row: Sequence[str], at: int) -> list[tuple[str, float]]:
    if header == ["time", "topic", "value"]:
        pairs = [(row[1], float(row[2]))]
    elif len(row) != len(header):
        raise ValueError
    else:
        pairs = [(name, float(cell)) for i, (name, cell) in enumerate(zip(header, row)) if i != at and cell != ""]
    return [(name, value) for name, value in pairs if math.isfinite(value)]
