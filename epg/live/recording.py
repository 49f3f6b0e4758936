# SPDX-License-Identifier: Apache-2.0
"""Recordings for a replay: a CSV file with every control cycle, every bit, and the changes of parameters.

The first line is a comment with facts about the target.  ``targets/platforms/host/src/replay.h`` defines the columns.
"""

from __future__ import annotations

import datetime
import json
from array import array
from collections import deque
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from epg.diagnostics import Diagnostics
from epg.live.client import Client, Description, Refused
from epg.live.rows import Row
from epg.source import Span

BEGIN = "# epg recording 1 "
UNKNOWN = "?"
"""In the column ``changes``: there were changes that the recording does not contain."""
MOST = 32
"""Signals of one stream."""


def signals_to_record(found: Description) -> list[str]:
    """The signals of a recording for a replay: all ports of the model, and what a replay needs beside them.

    :raises Refused: the target cannot be recorded
    """
    if not found.replay:
        raise Refused("its firmware was made by an EPG without replays: build it again")
    if len(found.signals) + len(found.replay) > MOST:
        count, most = len(found.signals), MOST - len(found.replay)
        raise Refused(f"its model has {count} ports, and a recording for a replay has at most {most}")
    return [signal.name for signal in (*found.signals, *found.replay)]


@dataclass
class _Waiting:
    """A row that waits for the changes of its cycle, which later rows can tell."""

    row: Row
    cycle: int
    changes: list[str] = field(default_factory=list)


class ReplayFile:
    """A sink of rows with the signals of :func:`signals_to_record`, which writes a recording for a replay.

    ``parameters`` are the names of the target's parameters.
    """

    def __init__(self, path: Path, client: Client) -> None:
        found = client.description
        self._parameters = tuple(parameter.name for parameter in found.parameters)
        self._ports = len(found.signals)
        self._waiting: deque[_Waiting] = deque()
        self._untold = 0
        self._number = -1
        self._file = path.open("w", encoding="utf-8", newline="\n")
        facts = {
            "name": found.name,
            "node": found.node,
            "epg": found.version,
            "hash": found.hash,
            "model": found.model,
            "period": found.period,
            "begin": datetime.datetime.now(datetime.timezone.utc).isoformat(timespec="milliseconds"),
        }
        names = ["time", "cycle", *(signal.name for signal in found.signals), "changes"]
        self._file.write(f"{BEGIN}{json.dumps(facts)}\n{','.join(names)}\n")

    def write(self, rows: Iterable[Row]) -> None:
        for row in rows:
            cycle, parameter, value, acted, untold = row.values[self._ports :]
            waiting = _Waiting(row, int(cycle))
            dropped = self._number >= 0 and row.number != self._number + 1
            self._waiting.append(waiting)
            if parameter < 0 or (dropped and self._untold > 0):
                waiting.changes.append(UNKNOWN)
            elif parameter > 0:
                self._tell(waiting, int(parameter) - 1, value, int(acted))
            self._number, self._untold = row.number, int(untold)
            if self._untold == 0:
                self._write_waiting()

    def close(self) -> None:
        """Closes the file.  Rows with changes that were not told are left out."""
        self._file.close()

    def _tell(self, teller: _Waiting, parameter: int, value: float, acted: int) -> None:
        """Adds a change to its row, which is that of the teller or an earlier one."""
        if parameter >= len(self._parameters):
            teller.changes.append(UNKNOWN)
            return
        for waiting in reversed(self._waiting):
            if waiting.cycle == acted:
                waiting.changes.append(f"{self._parameters[parameter]}={value!r}")
                return
            if waiting.cycle == 1:
                break
        if teller.cycle > 0:  # its row was dropped; a change in the cycle that disables the target needs none
            teller.changes.append(UNKNOWN)

    def _write_waiting(self) -> None:
        for waiting in self._waiting:
            time, values = f"{waiting.row.time:.9f}", map(repr, waiting.row.values[: self._ports])
            self._file.write(",".join((time, str(waiting.cycle), *values, " ".join(waiting.changes))) + "\n")
        self._waiting.clear()


@dataclass
class Recorded:
    """A recording.  ``cycles`` has the number of each row's control cycle since the enabling, or 0 while disabled.

    ``model`` and ``period`` are empty and 0 if the file does not state them.  ``columns`` are the values of the model's
    ports by name, and ``changes`` the changes of parameters by the index of their row.  ``first`` is the line of the
    first row.
    """

    path: Path
    first: int
    name: str = ""
    model: str = ""
    period: float = 0.0
    times: array[float] = field(default_factory=lambda: array("d"))
    cycles: array[int] = field(default_factory=lambda: array("q"))
    columns: dict[str, array[float]] = field(default_factory=dict)
    changes: dict[int, str] = field(default_factory=dict)

    @property
    def is_trace(self) -> bool:
        """True for the trace of a host program, which has no changes of parameters."""
        return not self.model

    def span(self, row: int) -> Span:
        return Span(str(self.path), self.first + row)


def read_recording(path: Path, diagnostics: Diagnostics) -> Recorded | None:
    """Reads a recording of ``epg live --record``, or a trace of a host program.  None after an error."""
    try:
        text = path.read_text(encoding="utf-8", errors="replace")
    except OSError as error:
        message = f"cannot read this file: {error.strerror}"
        diagnostics.error("replay-recording", Span(str(path)), message, hint=_HINT)
        return None
    lines = text.split("\n")[:-1]  # a last line without an end was cut off
    found = Recorded(path, first=2)
    if lines and lines[0].startswith(BEGIN):
        found.first = 3
        if not _take_facts(found, lines.pop(0)):
            diagnostics.error("replay-recording", Span(str(path), 1), "the facts in this line are damaged", hint=_HINT)
            return None
    names = lines[0].split(",") if lines else []
    wanted = ("time", "enabled") if found.is_trace else ("time", "cycle")
    if not set(wanted) <= set(names) or (not found.is_trace and names[-1] != "changes"):
        message = "this file is neither a recording of 'epg live --record' nor a trace of a host program"
        diagnostics.error("replay-recording", Span(str(path), found.first - 1), message, hint=_HINT)
        return None
    return found if _take_rows(found, names, lines[1:], diagnostics) else None


_HINT = "record one with 'epg live PORT --record FILE --send enable'"


def _take_facts(found: Recorded, line: str) -> bool:
    try:
        facts = json.loads(line.removeprefix(BEGIN))
        found.name, found.model, found.period = str(facts["name"]), str(facts["model"]), float(facts["period"])
    except (ValueError, KeyError, TypeError):
        return False
    return bool(found.model)


def _take_rows(found: Recorded, names: Sequence[str], lines: Sequence[str], diagnostics: Diagnostics) -> bool:
    ports = [index for index, name in enumerate(names) if name.startswith(("inputs.", "outputs."))]
    columns = [array("d") for _ in ports]
    time_at, state_at = names.index("time"), names.index("enabled" if found.is_trace else "cycle")
    before = 0
    for row, line in enumerate(lines):
        fields = line.rstrip("\r").split(",")
        try:
            if len(fields) != len(names):
                raise ValueError(f"this row has {len(fields)} columns, not {len(names)}")
            found.times.append(_number(fields[time_at]))
            state = _number(fields[state_at])
            for column, index in zip(columns, ports):
                column.append(_number(fields[index]))
            if found.is_trace:  # the first control cycle initialises the model, too
                starts_enabled = row == 0 and found.times[0] > 0.0
                state = before + 1 + (1 if starts_enabled else 0) if state > 0.5 else 0
            before = int(state)
            found.cycles.append(before)
        except (ValueError, OverflowError) as problem:
            hint = "the recording was changed after it was made: record the run again"
            diagnostics.error("replay-recording", found.span(row), str(problem), hint=hint)
            return False
        if not found.is_trace and fields[-1].strip():
            found.changes[row] = fields[-1].strip()
    found.columns = {names[index]: column for index, column in zip(ports, columns)}
    return True


def _number(text: str) -> float:
    try:
        return float(text)
    except ValueError:
        raise ValueError(f"'{text[:40]}' is not a number") from None
