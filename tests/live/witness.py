# SPDX-License-Identifier: Apache-2.0
"""A target with 20 signals whose actuator notes when it was driven, in the time of its own control cycles.

>>> # robot = Robot(build_robot(folder), folder); ...; robot.spans()
"""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import time
from pathlib import Path
from types import TracebackType
from typing import NamedTuple

import pytest

PROJECT = Path(__file__).resolve().parent / "robot"
SIGNALS = 20
CYCLE = 0.001
"""Seconds of a control cycle."""


class Span(NamedTuple):
    """A time in which the actuator was driven, in seconds of :func:`time.monotonic`."""

    begin: float
    """The begin of the first cycle that has driven it."""
    last: float
    """The begin of the last cycle that has driven it; infinite while it is driven."""
    safe: float
    """The time at which the next cycle has made it safe."""


def build_robot(build: Path) -> Path:
    """The host program, built in the folder ``build``."""
    for tool, package in (("cmake", "cmake"), ("ninja", "ninja-build")):
        if not shutil.which(tool):
            pytest.skip(f"{tool} is missing: apt install {package}")
    options = [f"-DPython3_EXECUTABLE={sys.executable}", "-DCMAKE_BUILD_TYPE=Release"]
    for command in (
        ["cmake", "-S", str(PROJECT), "-B", str(build), "-G", "Ninja", *options],
        ["cmake", "--build", str(build), "--target", "robot_host"],
    ):
        done = subprocess.run(command, capture_output=True, text=True, check=False, timeout=600)
        assert done.returncode == 0, done.stdout + done.stderr
    return build / "robot_host"


class Robot:
    """The running program.  ``port`` is the terminal that is its serial port."""

    def __init__(self, program: Path, folder: Path) -> None:
        self.port, self._file = folder / "port", folder / "witness"
        self._file.write_text("")
        self.process = subprocess.Popen(
            [str(program), "--realtime", "--console-pty", str(self.port)],
            stdout=subprocess.DEVNULL,
            env={**os.environ, "WITNESS_FILE": str(self._file)},
        )
        end = time.monotonic() + 10
        while not self.port.exists() and time.monotonic() < end:
            time.sleep(0.01)

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

    def wait(self, driven: bool, seconds: float = 5.0) -> None:
        """Waits until the actuator is driven, or is safe."""
        end = time.monotonic() + seconds
        while self.is_driven() != driven:
            assert time.monotonic() < end, f"driven={not driven}, not {driven}"
            time.sleep(0.002)

    def close(self) -> None:
        self.process.kill()
        self.process.wait()

    def __enter__(self) -> Robot:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, value: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()
