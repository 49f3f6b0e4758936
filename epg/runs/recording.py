# SPDX-License-Identifier: Apache-2.0
"""Recordings of a run, and the one reader of the CSV files that hold them.

Three forms are read:

- a table with a column ``time`` and a column for each signal: ``trace.csv``, ``tracking.csv``, rows of ``epg live``;
- the same with facts in its first line, and changes of parameters in its last column: ``epg live --record``;
- rows of ``time,topic,value``: ``topics.csv`` and ``setpoints.csv``.

A last line without an end is left out: the program that wrote the file was killed.
"""

from __future__ import annotations

import csv
import json
import math
import sys
from array import array
from bisect import bisect_right
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import field
from itertools import chain, islice
from pathlib import Path
from typing import Any, NamedTuple, TextIO

from epg.generator.dataclass import dataclass
from epg.generator.diagnostics import Diagnostics, did_you_mean
from epg.generator.source import Span

BEGIN = "# epg recording 1 "
"""The beginning of a first line with facts, which are a JSON object."""
CHANGES = "changes"
"""The last column of a file with facts."""
UNKNOWN = "?"
"""In this column: there were changes that the recording does not contain."""
ROWS = ("time", "topic", "value")
"""The columns of a file that has one value in each row."""
_SETPOINTS = "setpoints.csv"
_FOLDER_FILES = (_SETPOINTS, "topics.csv")
FIRST_AFTER_FACTS = 3
"""The line of the first row of a file with facts; without them, it is the second line."""
_ALL = sys.maxsize

_Rows = Iterator[tuple[float, "list[str]"]]
_Part = tuple[int, "dict[str, tuple[array[float], array[float]]]"]
"""The number of rows, and the times and values of each signal."""


@dataclass(frozen=True)
class Signal:
    """The values of a signal.  ``time`` is in seconds and never decreases."""

    time: Sequence[float]
    value: Sequence[float]

    def at(self, times: Sequence[float]) -> Sequence[float]:
        """The value at each of ``times``: the newest one, or the first one before it; NaN if there are no values.

        >>> list(Signal([1.0, 2.0], [5.0, 6.0]).at([0.0, 1.0, 1.9, 7.0]))
        [5.0, 5.0, 5.0, 6.0]
        """
        if times is self.time:
            return self.value
        if not self.value:
            return array("d", [math.nan]) * len(times)
        return array("d", (self.value[max(bisect_right(self.time, time) - 1, 0)] for time in times))


@dataclass(frozen=True)
class Recording:
    """The signals of a run by name, in the file or folder ``path``.

    ``setpoints`` are the names of the signals that are known to be setpoints.  ``model``, a hash, and ``period`` (s) of
    the target are empty and 0 without facts.  ``changes`` are changes of parameters by the index of
    their row, and ``first`` is the line of the first row.
    """

    path: Path
    signals: dict[str, Signal]
    setpoints: frozenset[str] = frozenset()
    model: str = ""
    period: float = 0.0
    changes: Mapping[int, str] = field(default_factory=dict)
    first: int = 2

    def span(self, row: int) -> Span:
        return Span(str(self.path), self.first + row)

    def check(self, name: str, option: str, diagnostics: Diagnostics) -> None:
        """Reports that there is no signal ``name``, which is the argument of ``option``."""
        if name not in self.signals:
            message, hint = f"'{name}' is not in {self.path}", did_you_mean(name, self.signals, "signals")
            diagnostics.error("unknown-recorded-signal", Span.of_argument(name, option), message, hint=hint)


class Row(NamedTuple):
    """A row: its time in seconds since the first row, one value per column, and its number.  Dropped rows count."""

    time: float
    values: Sequence[Any]
    number: int = 0


def signals_of(names: Sequence[str], rows: Iterable[Row]) -> dict[str, Signal]:
    """The signals whose values are in ``rows``, in the order of ``names``."""
    rows = list(rows)
    times = array("d", (row.time for row in rows))
    return {name: Signal(times, array("d", (row.values[at] for row in rows))) for at, name in enumerate(names)}


class WrongRecording(OSError):
    """The reason why a file cannot be read: its place (0: the whole file) and the id of the message to the user."""

    def __init__(self, id: str, problem: str, line: int = 0) -> None:
        super().__init__(problem)
        self.id, self.line = id, line


def read_table(path: Path, wanted: Callable[[str], bool] = lambda name: True) -> Recording:
    """All rows of a table, bit for bit: every signal has a value in each row.  Of an empty cell, it is NaN.

    Only signals whose name is ``wanted`` are read.  Raises WrongRecording.
    """
    with _open(path) as file:
        (signals,) = file.parts(wanted, _ALL, ordered=False)
        return Recording(path, signals, frozenset(), *file.facts, file.changes, file.first)


def read_recording(path: Path, diagnostics: Diagnostics, most: int | None = None) -> Recording | None:
    """The recording in the file or folder ``path``.  None if it is wrong; the reason is reported.

    Values that are not finite are left out, and so are events of the host platform, whose names begin with ``$``.
    ``most`` is the greatest number of points of a signal, for a plot; without it, all points are kept.
    """
    points: dict[str, _Points] = {}
    setpoints: frozenset[str] = frozenset()
    before = diagnostics.error_count
    for file in _files(path, diagnostics):
        try:
            with _open(file) as text:
                for part in text.parts(lambda name: not name.startswith("$"), most or _ALL, ordered=True):
                    for name, signal in part.items():
                        points.setdefault(name, _Points(most)).take(signal)
            setpoints = setpoints or frozenset(points if file.name == _SETPOINTS else ())
        except WrongRecording as problem:
            span = Span(str(file), problem.line, 1, 2) if problem.line else Span(str(file))
            diagnostics.error(problem.id, span, str(problem))
    if diagnostics.error_count > before:
        return None
    signals = {name: found.signal for name, found in points.items() if found.signal.value}
    if not signals:
        diagnostics.error("no-recording", Span(str(path)), "this recording is empty")
        return None
    return Recording(path, signals, setpoints & signals.keys())


def _files(path: Path, diagnostics: Diagnostics) -> list[Path]:
    """The files of the recording ``path``; none after an error."""
    if not path.is_dir():
        return [path]
    files = [path / name for name in _FOLDER_FILES if (path / name).is_file()]
    if not files:
        hint = f"the folder of a recording contains {' or '.join(_FOLDER_FILES)}"
        diagnostics.error("no-recording", Span(str(path)), "there is no recording here", hint=hint)
    return files


@contextmanager
def _open(path: Path) -> Iterator[_CsvText]:
    try:
        with path.open(encoding="utf-8", newline="") as text:
            yield _CsvText(text)
    except WrongRecording:
        raise
    except FileNotFoundError:
        raise WrongRecording("file-not-found", f"there is no file '{path}'") from None
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        raise WrongRecording("file-unreadable", f"cannot read '{path.name}': {error}") from None


class _CsvText:
    """The text of one file: its ``facts`` (model, period), its columns ``names``, and its rows."""

    def __init__(self, text: TextIO) -> None:
        lines = (line for line in text if line.endswith(("\n", "\r")))
        begin = next(lines, "")
        self.facts: tuple[str, float] = ("", 0.0)
        self.changes: dict[int, str] = {}
        self.first = 2
        if begin.startswith(BEGIN):
            self.facts, self.first, begin = _facts(begin), FIRST_AFTER_FACTS, next(lines, "")
        self._rows = csv.reader(chain((begin,), lines))
        self._names = next(self._rows, [])
        if "time" not in self._names or (self.first == FIRST_AFTER_FACTS and self._names[-1] != CHANGES):
            message = "this is not a recording: its first line does not name a column 'time'"
            raise WrongRecording("not-a-recording", message, self.first - 1)
        self._time = self._names.index("time")

    def parts(self, wanted: Callable[[str], bool], most: int, *, ordered: bool) -> Iterator[dict[str, Signal]]:
        """The signals that are ``wanted``, in parts of at most ``most`` rows.  Raises WrongRecording.

        If the file must be ``ordered``, the time does not decrease.
        """
        rows = self._times_and_rows(ordered)
        take = self._list_part if tuple(self._names) == ROWS else self._table_part
        count = most
        while count == most:
            count, part = take(islice(rows, most), wanted)
            yield {name: Signal(*signal) for name, signal in part.items()}

    def _table_part(self, rows: _Rows, wanted: Callable[[str], bool]) -> _Part:
        texts = {"time", CHANGES} if self.first == FIRST_AFTER_FACTS else {"time"}
        at = {name: index for index, name in enumerate(self._names) if name not in texts and wanted(name)}
        times = array("d")
        part = {name: (times, array("d")) for name in at}
        columns = [(at[name], values) for name, (_, values) in part.items()]
        for time, row in rows:
            times.append(time)
            for index, values in columns:
                values.append(self._number(row[index] or "nan"))
        return len(times), part

    def _list_part(self, rows: _Rows, wanted: Callable[[str], bool]) -> _Part:
        part: dict[str, tuple[array[float], array[float]]] = {}
        count = 0
        for time, (_, name, value) in rows:
            count += 1  # enumerate() has no number if there are no rows
            if wanted(name):  # a command to the host platform can have a text
                number = self._number(value)
                times, values = part.setdefault(name, (array("d"), array("d")))
                times.append(time)
                values.append(number)
        return count, part

    def _times_and_rows(self, ordered: bool) -> Iterator[tuple[float, list[str]]]:
        latest, count = -math.inf, 0
        for row in filter(None, self._rows):
            if len(row) != len(self._names):
                raise self._wrong(f"this row has {len(row)} columns, not {len(self._names)}")
            time = self._number(row[self._time])
            if ordered and not time >= latest:
                raise self._wrong(f"the time decreases from {latest:g} s to {time:g} s")
            if self.first == FIRST_AFTER_FACTS and row[-1].strip():
                self.changes[count] = row[-1].strip()
            latest, count = time, count + 1
            yield time, row

    def _number(self, text: str) -> float:
        try:
            return float(text)
        except ValueError:
            raise self._wrong(f"'{text[:40]}' is not a number") from None

    def _wrong(self, problem: str) -> WrongRecording:
        return WrongRecording("wrong-recording", problem, self._rows.line_num + self.first - 2)


def _facts(line: str) -> tuple[str, float]:
    """The model and the control period of a target."""
    try:
        facts = json.loads(line.removeprefix(BEGIN))
        found = str(facts["model"]), float(facts["period"])
        if not found[0]:
            raise ValueError
    except (ValueError, KeyError, TypeError):
        raise WrongRecording("wrong-recording", "the facts in this line are damaged", 1) from None
    return found


class _Points:
    """The finite points of a signal, at most ``most`` of them.

    If there are more, points between equal ones go, and then two of four: the least and the greatest stay, so that a
    plot shows every peak.  The memory does not grow with the length of a recording.
    """

    def __init__(self, most: int | None) -> None:
        self._time: Sequence[float] = ()
        self._value: Sequence[float] = ()
        self._most = most

    @property
    def signal(self) -> Signal:
        return Signal(self._time, self._value)

    def take(self, signal: Signal) -> None:
        if not all(map(math.isfinite, signal.value)):
            finite = [at for at, value in enumerate(signal.value) if math.isfinite(value)]
            signal = Signal(_chosen(signal.time, finite), _chosen(signal.value, finite))
        if self._time:
            signal = Signal(array("d", (*self._time, *signal.time)), array("d", (*self._value, *signal.value)))
        self._time, self._value = signal.time, signal.value
        if self._most is not None and len(self._time) > self._most:
            self._keep(self._without_repeats())
            while len(self._time) > self._most // 2:
                self._keep(self._extremes())

    def _keep(self, kept: list[int]) -> None:
        self._time, self._value = _chosen(self._time, kept), _chosen(self._value, kept)

    def _without_repeats(self) -> list[int]:
        value, last = self._value, len(self._value) - 1
        return [at for at in range(last + 1) if at in (0, last) or not value[at - 1] == value[at] == value[at + 1]]

    def _extremes(self) -> list[int]:
        kept = []
        for begin in range(0, len(self._value), 4):
            four = range(begin, min(begin + 4, len(self._value)))
            kept += sorted({min(four, key=self._value.__getitem__), max(four, key=self._value.__getitem__)})
        return kept


def _chosen(values: Sequence[float], indices: Sequence[int]) -> Sequence[float]:
    return array("d", (values[at] for at in indices))
