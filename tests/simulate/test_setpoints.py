# SPDX-License-Identifier: Apache-2.0
"""What moves is fresh: closed loops in which a sender dies, a stop is short, or a setpoint is outside of the axis."""

from __future__ import annotations

import csv
import json
import math
import shutil
import subprocess
import sys
from collections.abc import Iterable
from pathlib import Path
from typing import NamedTuple

import pytest

PROJECT = Path(__file__).resolve().parent / "setpoints"


class Run(NamedTuple):
    """The values of each cycle, by signal, and the statistics."""

    rows: list[dict[str, float]]
    statistics: dict[str, object]

    def between(self, signal: str, begin: float, end: float) -> list[float]:
        """The values of a signal in the cycles from ``begin`` to before ``end`` (s)."""
        return [row[signal] for row in self.rows if begin - 1e-9 <= row["time"] < end - 1e-9]

    def at(self, signal: str, time: float) -> float:
        return self.between(signal, time, time + 1e-3)[0]


@pytest.fixture(scope="module")
def build(tmp_path_factory: pytest.TempPathFactory) -> Path:
    if not shutil.which("cmake"):
        pytest.skip("CMake is not installed: sudo apt install cmake")
    folder = tmp_path_factory.mktemp("setpoints")
    generator = ["-G", "Ninja"] if shutil.which("ninja") else []
    for command in (
        ["cmake", "-S", str(PROJECT), "-B", str(folder), *generator, f"-DPython3_EXECUTABLE={sys.executable}"],
        ["cmake", "--build", str(folder)],
    ):
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stdout + done.stderr
    return folder


def run(build: Path, target: str, events: Iterable[str], seconds: float) -> Run:
    (build / "in.csv").write_text("\n".join(("time,topic,value", *events, "")))
    files = ["--setpoints", "in.csv", "--trace", "out.csv", "--statistics", "out.json", "--duration", str(seconds)]
    subprocess.run([build / f"{target}_host", "--quiet", *files], cwd=build, check=True)
    with (build / "out.csv").open(newline="") as file:
        rows = [{key: float(value) for key, value in row.items()} for row in csv.DictReader(file)]
    return Run(rows, json.loads((build / "out.json").read_text()))


def test_a_velocity_whose_sender_dies_ends_after_half_a_second(build: Path) -> None:
    found = run(build, "velocity", ("0,$enable,1", *(f"{0.1 * i},speed,0.8" for i in range(1, 20))), 10.0)
    assert set(found.between("outputs.duty", 0.1, 2.4)) == {0.04}
    assert set(found.between("outputs.duty", 2.401, 10.0)) == {0.0}  # the last value was sent at 1.9 s
    assert (found.statistics["fault"], found.statistics["setpoint_timeouts"]) == ("none", 1)
    assert found.at("plant.outputs.speed", 3.0) == pytest.approx(0.0, abs=1e-3)


def test_a_velocity_that_was_sent_before_the_enabling_does_nothing(build: Path) -> None:
    found = run(build, "velocity", ("1,speed,0.8", "8,$enable,1", "9,speed,0.8"), 10.0)
    assert set(found.between("outputs.duty", 8.0, 9.0)) == {0.0}
    assert found.at("enabled", 8.5) == 1
    assert found.at("plant.outputs.angle", 8.99) == 0.0
    assert set(found.between("outputs.duty", 9.0, 9.5)) == {0.04}


def test_a_velocity_does_not_act_twice_over_a_short_stop(build: Path) -> None:
    found = run(build, "velocity", ("0,$enable,1", "1,speed,0.8", "1.45,$enable,0", "1.46,$enable,1"), 3.0)
    assert set(found.between("outputs.duty", 1.0, 1.45)) == {0.04}
    assert set(found.between("outputs.duty", 1.46, 3.0)) == {0.0}


def test_the_rate_limit_begins_at_the_initial_value(build: Path) -> None:
    """The sender died at 4.7 s at full speed; the target is enabled at 60 s."""
    sent = [f"{0.1 * i},speed,16" for i in range(1, 48)]
    found = run(build, "limited", ("0,$enable,1", *sent, "60,$enable,1", "61,speed,-2"), 61.2)
    assert found.at("outputs.duty", 4.6) == 0.8
    assert found.at("enabled", 6.0) == 0
    assert found.statistics["faults"] == 1
    assert found.at("enabled", 60.5) == 1
    assert set(found.between("outputs.duty", 60.0, 61.0)) == {0.0}
    assert found.at("inputs.speed", 61.0) == pytest.approx(-0.004)  # 4 rad/s in each second
    assert found.at("inputs.speed", 61.1) == pytest.approx(-0.404)


def test_a_position_outside_of_its_limits_is_refused(build: Path) -> None:
    events = ("0,$enable,1", "0.5,target,60", "1,target,60.1", "1.5,target,-1e9", "2,target,nan")
    found = run(build, "servo", events, 3.0)
    assert found.statistics["setpoints_dropped"] == 3
    assert found.between("inputs.target", 0.5, 3.0) == pytest.approx([math.radians(60)] * 2500)
    assert found.at("plant.outputs.angle", 2.99) == pytest.approx(math.radians(60), abs=1e-3)
    assert max(row["plant.outputs.angle"] for row in found.rows) < math.radians(65)


def test_enabling_begins_where_the_axis_is(build: Path) -> None:
    """The topic is in degrees, and the model in radians.  The axis stops at its own speed, somewhere."""
    events = ("0,$enable,1", "0.5,target,60", "0.7,$enable,0", "1.2,target,-80", "2,$enable,1", "3,target,-20")
    found = run(build, "servo", events, 5.0)
    stopped = found.at("inputs.position", 2.0)
    assert math.radians(10) < stopped < math.radians(59)  # on its way to 60 degrees
    assert found.between("inputs.target", 2.0, 3.0) == pytest.approx([stopped] * 1000, abs=1e-12)
    duties = found.between("outputs.duty", 2.0, 3.0)
    assert max(map(abs, duties)) < 1e-4  # it is at rest, apart from less than a count
    assert found.at("plant.outputs.angle", 2.99) == pytest.approx(found.at("plant.outputs.angle", 2.0), abs=1e-4)
    assert found.at("inputs.target", 3.0) == pytest.approx(math.radians(-20))
    assert found.at("plant.outputs.angle", 4.99) == pytest.approx(math.radians(-20), abs=1e-3)
