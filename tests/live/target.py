# SPDX-License-Identifier: Apache-2.0
"""A running target for tests: JIWY with its simulated plant, in real time, with a terminal as its serial port."""

from __future__ import annotations

import csv
import subprocess
from collections.abc import Container, Iterator, Sequence
from contextlib import contextmanager
from itertools import dropwhile
from math import isclose
from pathlib import Path

import pytest

from epg.live.client import Client, Rows, words_of
from epg.live.open import open_port
from tests.middlewares.conftest import build_jiwy
from tests.waiting import until, waited

LEASE = 0.3  # seconds
LATE = 0.4  # more seconds that this computer may take; the times of the target itself are tested in c/live_tests.c


@pytest.fixture(scope="session")
def jiwy_host(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return build_jiwy(tmp_path_factory.mktemp("jiwy"), "address,undefined")


def read_trace(file: Path) -> list[dict[str, float]]:
    """The rows of a trace, one for each cycle that ran."""
    with file.open(encoding="ascii") as opened:
        return [{name: float(value) for name, value in row.items()} for row in csv.DictReader(opened)]


TimedRow = tuple[float, Sequence[float]]


def check_every_cycle_has_a_row(
    names: Sequence[str],
    rows: Sequence[TimedRow],
    cycles: Sequence[dict[str, float]],
    every: int = 1,
    dropped: Container[int] = (0,),
) -> None:
    """Compares rows, each with its time, with the trace of their target: each ``every``-th cycle must have one.

    A late computer leaves out cycles.  The target counts these as missed, and they are neither in the rows nor in the
    trace.  ``dropped`` are the possible numbers of rows that the program that received them has counted as missing.
    """
    known = [(number, name) for number, name in enumerate(names) if name.startswith(("inputs.", "outputs."))]

    def fits(row: TimedRow, cycle: dict[str, float], begin: float) -> bool:
        values = (isclose(row[1][number], cycle[name], rel_tol=1e-6, abs_tol=1e-30) for number, name in known)
        return abs(row[0] - rows[0][0] - (cycle["time"] - begin)) < 1e-5 and all(values)

    longest = missing = 0
    for first in range(len(cycles)):
        begin = cycles[first]["time"]
        place, count = first, 0  # of the next cycle; of the rows that fit
        for row in rows:
            while place < len(cycles) and cycles[place]["time"] - begin < row[0] - rows[0][0] - 1e-5:
                place += every
            if place >= len(cycles) or not fits(row, cycles[place], begin):
                break
            place, count = place + every, count + 1
        skipped = (place - first) // every - count
        if count == len(rows) and skipped in dropped:
            return
        if count > longest:
            longest, missing = count, skipped
    raise AssertionError(
        f"from row {longest} of {len(rows)} on, rows and cycles of the target differ; {missing} are missing before"
    )


@contextmanager
def client_of(path: Path) -> Iterator[Client]:
    """A client of a target."""
    with open_port(path) as port:
        client = Client(port)
        try:
            yield client
        finally:
            client.stop()


def let_pass(client: Client, seconds: float) -> None:
    """Waits until the target has run for some seconds of its own time."""
    end = now(client) + seconds
    until(lambda: now(client) > end)


def now(client: Client) -> float:
    """The target's own time in seconds."""
    return float(dict(words_of(client.command("stats")[0]))["time"])


KNOWN = 0.625
"""A setpoint in rad that no test sends: the cycle in which it appears is known in a trace, and in a stream."""


def tick_of(path: Path, setpoint: float = KNOWN) -> float:
    """The monotonic time of the first cycle with this setpoint.  The target gets it now, and is enabled for it."""
    got: list[Rows] = []
    with client_of(path) as client:
        client.disable()
        client.enable(unattended=True)
        client.stop_stream()  # that of a program which has just closed the port may still run
        stream = [signal.name for signal in client.description.signals].index("inputs.setpoint_pan")
        client.start_stream([stream], 1, got.append)
        client.command(f"pan_subscriber={setpoint}")
        until(lambda: got and got[-1].values[-1] == setpoint, "no row has the setpoint")
        client.stop_stream()
        client.disable()
    return next(
        rows.tick + number * 0.001 for rows in got for number, value in enumerate(rows.values) if value == setpoint
    )


def begin_of(cycles: Sequence[dict[str, float]], tick: float) -> float:
    """The monotonic time of a trace's time 0, if :func:`tick_of` has returned ``tick``."""
    return tick - next(cycle["time"] for cycle in cycles if cycle["inputs.setpoint_pan"] == KNOWN)


def last_enabled(cycles: Sequence[dict[str, float]], tick: float) -> float:
    """The monotonic time of the last enabled cycle before :func:`tick_of`, which has returned ``tick``."""
    begin = begin_of(cycles, tick)
    before = [cycle for cycle in cycles if begin + cycle["time"] < tick]
    earlier = dropwhile(lambda cycle: cycle["enabled"], reversed(before))
    return begin + next(cycle["time"] for cycle in earlier if cycle["enabled"])


class Target:
    """The program, and the terminal that is its serial port."""

    def __init__(self, program: Path, folder: Path) -> None:
        self.port, self._trace = folder / "port", folder / "trace.csv"
        trace = ("--trace", str(self._trace), "--duration", "3600")
        self.process = subprocess.Popen(
            [str(program), "--realtime", "--console-pty", str(self.port), *trace],
            stdout=subprocess.PIPE,
            text=True,
            cwd=folder,
        )
        until(self.port.exists, "the target has no port")

    def report(self) -> str:
        """Ends the program and returns its report."""
        self.process.terminate()
        return self.process.communicate(timeout=20)[0]

    def cycles(self) -> list[dict[str, float]]:
        """Ends the program and returns the cycles that ran, each with its values."""
        self.report()
        return read_trace(self._trace)

    def last_enabled(self) -> float:
        """The monotonic time of the last cycle that was enabled; ends the program, whose port no other one may have."""
        tick = tick_of(self.port)
        return last_enabled(self.cycles(), tick)

    def was_late(self) -> bool:
        """True if its process had no processor for longer than the terminal keeps rows of a few signals.

        Then the program that reads them had none either, and the target drops rows.  Both count them.
        """
        return waited(self.process.pid) > 0.05

    def is_enabled(self) -> bool:
        """Asks a port that no program has."""
        with client_of(self.port) as client:
            return "enabled=1" in client.command("stats")[0]


@pytest.fixture
def target(jiwy_host: Path, tmp_path: Path) -> Iterator[Target]:
    found = Target(jiwy_host, tmp_path)
    yield found
    found.process.kill()
    found.process.communicate()
