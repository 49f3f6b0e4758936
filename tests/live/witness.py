# SPDX-License-Identifier: Apache-2.0
"""A target with 20 signals whose actuator notes when it was driven, in the time of its own control cycles.

>>> # robot = Robot(build_robot(folder), folder); ...; robot.spans()
"""

from __future__ import annotations

import os
import subprocess
from pathlib import Path
from typing import NamedTuple

from tests.cmake.built import built
from tests.waiting import PATIENCE, until

PROJECT = Path(__file__).resolve().parent / "robot"
SIGNALS = 20
CYCLE = 0.001
"""Seconds of a control cycle."""


class Span(NamedTuple):
    """A time in which the actuator was driven, in seconds of the monotonic clock."""

    begin: float
    """The begin of the first cycle that has driven it."""
    last: float
    """The begin of the last cycle that has driven it; infinite while it is driven."""
    safe: float
    """The time at which the next cycle has made it safe."""


def build_robot(build: Path, project: Path = PROJECT) -> Path:
    """The host program of a project, built in the folder ``build``."""
    return built(project, build, "-DCMAKE_BUILD_TYPE=Release", targets=["robot_host"]) / "robot_host"


class Robot:
    """The running program.  ``port`` is the terminal that is its serial port, with ``udp`` the name of its UDP port."""

    def __init__(self, program: Path, folder: Path, *, udp: bool = False) -> None:
        self.port, self._file = folder / "port", folder / "witness"
        self._file.write_text("")
        console = ("--console-udp", "0") if udp else ("--console-pty", str(self.port))
        self.process = subprocess.Popen(
            [str(program), "--realtime", *console],
            stdout=subprocess.DEVNULL,
            stderr=subprocess.PIPE if udp else None,
            env={**os.environ, "WITNESS_FILE": str(self._file)},
            text=True,
        )
        if udp:
            assert self.process.stderr is not None
            self.port = Path(self.process.stderr.readline().split()[-1])
            return
        until(self.port.exists, "the target has no port")

    def spans(self) -> list[Span]:
        """The times in which the actuator was driven."""
        found: list[Span] = []
        for line in self._file.read_text(encoding="ascii").splitlines():
            event, *numbers = line.split()
            times = [1e-9 * int(number) for number in numbers]
            if event == "drive":
                found.append(Span(times[0], float("inf"), float("inf")))
            else:
                found[-1] = Span(found[-1].begin, *times)
        return found

    def is_driven(self) -> bool:
        spans = self.spans()
        return bool(spans) and spans[-1].safe == float("inf")

    def wait(self, driven: bool, seconds: float = PATIENCE) -> None:
        """Waits until the actuator is driven, or is safe."""
        until(lambda: self.is_driven() == driven, f"driven={not driven}, not {driven}", seconds, pause=0.002)

    def close(self) -> None:
        self.process.kill()
        self.process.communicate()

    def __enter__(self) -> Robot:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()
