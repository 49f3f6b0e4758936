# SPDX-License-Identifier: Apache-2.0
"""The same configuration on the host: with the simulated robot, or with the inputs that an image has sampled."""

from __future__ import annotations

import hashlib
import os
import shutil
import subprocess
import sys
from collections.abc import Mapping
from pathlib import Path

import pytest

from epg.bootstrap import cache_folder
from epg.simulate.executable import read_trace, run_executable
from epg.simulate.scenario import Scenario
from epg.simulate.setpoints import setpoint_rows, write_setpoints
from tests.emulator.toolchain import locked

from .recording import Recording
from .robot import AXES

PROJECT = Path(__file__).resolve().parent / "project"
Columns = dict[str, "list[float]"]


def host_programs(angles: Mapping[str, float]) -> Path:
    """Build folder with jiwy_host and jiwy_replay_host; ``angles`` are the first angles of the simulated robot."""
    for tool, package in (("cmake", "cmake"), ("ninja", "ninja-build")):
        if not shutil.which(tool):
            pytest.skip(f"{tool} is missing: apt install {package}")
    settings = {f"START_{axis.upper()}": repr(angle) for axis, angle in sorted(angles.items())}
    settings["Python3_EXECUTABLE"] = sys.executable
    digest = hashlib.sha256(repr((str(PROJECT), sorted(settings.items()))).encode()).hexdigest()[:16]
    folder: Path = cache_folder() / "test-build" / f"closed-loop-host-{digest}"
    with locked(folder):
        defined = [f"-D{name}={value}" for name, value in settings.items()]
        for command in (
            ["cmake", "-S", str(PROJECT), "-B", str(folder), "-G", "Ninja", *defined],
            ["cmake", "--build", str(folder), "--parallel", "2"],
        ):
            done = subprocess.run(command, capture_output=True, text=True, check=False)
            assert done.returncode == 0, done.stdout + done.stderr
    return folder


def simulated(programs: Path, scenario: Scenario, signals: list[str], folder: Path) -> Columns:
    """``signals`` of the host's run of ``scenario`` against its own simulated robot."""
    write_setpoints(setpoint_rows(scenario), folder / "setpoints.csv")
    return _run(programs / "jiwy_host", float(scenario.duration), signals, folder)


def replayed(programs: Path, recording: Recording, signals: list[str], folder: Path) -> Columns:
    """``signals`` of the host's run with the counts and the setpoints that the image had in each cycle."""
    lines = ["time,topic,value\n"]
    before = {axis.name: 0.0 for axis in AXES}
    for number in range(recording.cycles):
        for axis in before:
            value = recording.columns[f"inputs.setpoint_{axis}"][number]
            if value != before[axis]:
                lines.append(f"{number / 1000:.3f},{axis}_subscriber,{value!r}\n")
                before[axis] = value
    (folder / "setpoints.csv").write_text("".join(lines), encoding="utf-8")
    rows = zip(*(recording.counts[axis.name] for axis in AXES), strict=True)
    centres = (" ".join(repr((count + 0.5) * axis.rad_per_count) for count, axis in zip(row, AXES)) for row in rows)
    (folder / "angles.txt").write_text("\n".join(centres) + "\n", encoding="utf-8")
    os.environ["RECORDING"] = str(folder / "angles.txt")
    try:
        return _run(programs / "jiwy_replay_host", recording.cycles / 1000, signals, folder)
    finally:
        del os.environ["RECORDING"]


def _run(program: Path, duration: float, signals: list[str], folder: Path) -> Columns:
    run_executable(
        program, folder, duration, folder / "setpoints.csv", realtime=False, progress=lambda message: None
    )  # fmt: skip
    trace = read_trace(folder / "trace.csv", signals)
    return {name: list(values) for name, values in trace.items()}
