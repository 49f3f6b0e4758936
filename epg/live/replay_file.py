# SPDX-License-Identifier: Apache-2.0
"""Writes recordings for a replay: a CSV file with every control cycle, every bit, and the changes of parameters.

The first line is a comment with facts about the target.  ``files/replay.h`` of the host defines the columns.
"""

from __future__ import annotations

import datetime
from collections import deque
from collections.abc import Iterable
from dataclasses import dataclass, field
from pathlib import Path

from epg.live.client import Client, CommandRefused, TargetDescription
from epg.runs.csv_file import CsvFile
from epg.runs.recording import CHANGES, UNKNOWN, Row

MOST = 32
"""Signals of one stream."""


def signals_to_record(description: TargetDescription) -> list[str]:
    """The signals of a recording for a replay: all ports of the model, and what a replay needs beside them.

    :raises Refused: the target cannot be recorded
    """
    if not description.replay:
        raise CommandRefused("its firmware was made by an EPG without replays: build it again")
    if len(description.signals) + len(description.replay) > MOST:
        count, most = len(description.signals), MOST - len(description.replay)
        raise CommandRefused(f"its model has {count} ports, and a recording for a replay has at most {most}")
    return [signal.name for signal in (*description.signals, *description.replay)]


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
        description = client.description
        self._parameters = tuple(parameter.name for parameter in description.parameters)
        self._ports = len(description.signals)
        self._waiting: deque[_Waiting] = deque()
        self._untold = 0
        self._number = -1
        facts = {
            "name": description.name,
            "node": description.node,
            "epg": description.version,
            "hash": description.hash,
            "model": description.model,
            "period": description.period,
            "begin": datetime.datetime.now(datetime.timezone.utc).isoformat(timespec="milliseconds"),
        }
        names = ["cycle", *(signal.name for signal in description.signals), CHANGES]
        self._file = CsvFile(path, names, "%.9f", "%s", facts)

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

    def flush(self) -> None:
        self._file.flush()

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
        self._file.write(
            Row(each.row.time, (each.cycle, *each.row.values[: self._ports], " ".join(each.changes)))
            for each in self._waiting
        )
        self._waiting.clear()
