# SPDX-License-Identifier: Apache-2.0
"""The same configuration on the host: with the simulated robot, or with the inputs that an image has sampled."""

from __future__ import annotations

import hashlib
import os
import sys
from collections.abc import Mapping
from pathlib import Path

from epg.generator.bootstrap import cache_folder
from epg.runs.executable import run_executable
from epg.runs.recording import read_table
from epg.runs.scenario import Scenario
from epg.runs.setpoint_file import setpoint_rows, write_setpoints
from tests.cmake.built import built
from tests.doubles.toolchain import locked

from .recording import Recording
from .robot import AXES

PROJECT = Path(__file__).resolve().parent / "project"
Columns = dict[str, "list[float]"]


def host_programs(angles: Mapping[str, float]) -> Path:
    """Build folder with jiwy_host and jiwy_replay_host; ``angles`` are the first angles of the simulated robot."""
    settings = {f"START_{axis.upper()}": repr(angle) for axis, angle in sorted(angles.items())}
    digest = hashlib.sha256(repr((str(PROJECT), sys.executable, sorted(settings.items()))).encode()).hexdigest()[:16]
    folder: Path = cache_folder() / "test-build" / f"closed-loop-host-{digest}"
    with locked(folder):
        built(PROJECT, folder, *(f"-D{name}={value}" for name, value in settings.items()))
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
    trace = read_table(folder / "trace.csv", signals.__contains__).signals
    return {"time": list(trace[signals[0]].time), **{name: list(signal.value) for name, signal in trace.items()}}
