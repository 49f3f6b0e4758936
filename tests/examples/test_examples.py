# SPDX-License-Identifier: Apache-2.0
"""The examples, built with CMake as in their README, and the reactions of their robots to faults."""

from __future__ import annotations

import csv
import json
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parent.parent.parent


def run(command: str, **variables: str) -> str:
    environment = {k: v for k, v in os.environ.items() if k not in ("EPG_DIR", "EPG_PATH")} | variables
    done = subprocess.run(command, shell=True, cwd=ROOT, capture_output=True, text=True, env=environment)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


@pytest.fixture(scope="module")
def jiwy(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Build folder of JIWY's program."""
    folder = tmp_path_factory.mktemp("jiwy")
    configure = f"cmake -S examples/jiwy -B {folder} -DPython3_EXECUTABLE={sys.executable}"
    run(f"{configure} && cmake --build {folder} --target jiwy_host")
    return folder


def simulate(
    folder: Path, setpoints: str, duration: float, *options: str
) -> tuple[list[dict[str, str]], dict[str, object]]:
    """Trace and statistics of a run with the given setpoints, enabled at 0 s."""
    (folder / "in.csv").write_text("time,topic,value\n0,$enable,1\n" + setpoints)
    files = ["--setpoints", "in.csv", "--trace", "out.csv", "--statistics", "out.json", "--duration", str(duration)]
    subprocess.run([folder / "jiwy_host", "--quiet", *files, *options], cwd=folder, check=True)
    with (folder / "out.csv").open(newline="") as file:
        return list(csv.DictReader(file)), json.loads((folder / "out.json").read_text())


def test_the_readmes_first_command(tmp_path: Path) -> None:
    readme = (ROOT / "README.md").read_text(encoding="utf-8")
    (command, *_) = re.findall(r"^cmake .*$", readme, re.MULTILINE)
    assert command.count("build/jiwy") == 2
    folder = tmp_path / "jiwy"
    output = run(
        command.replace("build/jiwy", str(folder)).replace("-B", f"-DPython3_EXECUTABLE={sys.executable} -B", 1)
    )
    for words in (
        "cycles",
        "overruns",
        "RMS error",
        "largest error",
        "computation time",
        "simulated time",
        "wall time",
    ):
        assert words in output
    rms = {
        (axis, start): float(value)
        for axis, start, value in re.findall(r"^(pan|tilt)\s+(\S+) \.\.\. \S+ s\s+(\S+) rad", output, re.M)
    }
    assert rms["pan", "5"] <= 0.03
    assert rms["tilt", "5"] <= 0.05
    assert (folder / "tracking.png").read_bytes().startswith(b"\x89PNG")
    header, *rows = (folder / "tracking.csv").read_text().splitlines()
    assert {"time", "pan_setpoint", "pan_reference", "pan_position"} <= {c.split(" ")[0] for c in header.split(",")}
    assert len(rows) == 18_000


def test_nothing_moves_before_somebody_enables(jiwy: Path) -> None:
    files = ["--trace", "still.csv", "--statistics", "still.json", "--duration", "3"]
    subprocess.run([jiwy / "jiwy_host", "--quiet", *files], cwd=jiwy, check=True)
    statistics = json.loads((jiwy / "still.json").read_text())
    assert (statistics["enabled"], statistics["fault"]) == (False, "none")
    with (jiwy / "still.csv").open(newline="") as file:
        duties = {row[f"plant.inputs.duty_{axis}"] for row in csv.DictReader(file) for axis in ("pan", "tilt")}
    assert duties == {"0"}


def test_two_runs_are_equal(jiwy: Path) -> None:
    traces = []
    for _ in range(2):
        simulate(jiwy, "5.0,pan_subscriber,0.5\n", 6.0)
        traces.append((jiwy / "out.csv").read_bytes())
    assert traces[0] == traces[1]


def test_homing_is_gentle_and_ends(jiwy: Path) -> None:
    rows, _ = simulate(jiwy, "", 4.5)
    for axis, limit in (("pan", 0.05), ("tilt", 0.06)):
        duties = [abs(float(row[f"outputs.pwm_{axis}"])) for row in rows]
        assert max(duties[:2000]) <= limit + 1e-12
        assert max(duties) <= 0.2, "the hand-over to the controller kicks"
        assert any(float(row[f"outputs.encoder_reset_{axis}"]) > 0.5 for row in rows)
        assert abs(float(rows[-1][f"inputs.position_{axis}"])) < 0.02


def test_disabling_lets_the_robot_coast_and_keeps_positions_live(jiwy: Path) -> None:
    setpoints = "".join(f"{5 + 0.033 * i:.3f},pan_subscriber,{0.02 * i:.3f}\n" for i in range(50)) + "6.7,$enable,0\n"
    setpoints = "".join(sorted(setpoints.splitlines(keepends=True), key=lambda line: float(line.split(",")[0])))
    rows, statistics = simulate(jiwy, setpoints, 8.0)
    assert abs(float(rows[6690]["plant.inputs.duty_pan"])) > 0
    after = rows[6702:]
    assert all(float(row["plant.inputs.duty_pan"]) == 0 for row in after)
    angles = [float(row["plant.outputs.angle_pan"]) for row in after]
    positions = [float(row["inputs.position_pan"]) for row in after]
    assert abs(angles[-1] - angles[-200]) < 1e-6, "the motor coasts to a stop"
    assert abs(positions[-1] - angles[-1]) < 0.02, "the zero position is kept"
    assert statistics["enabled"] is False
    assert statistics["fault"] == "none"


def test_a_non_finite_setpoint_is_dropped(jiwy: Path) -> None:
    rows, statistics = simulate(jiwy, "5.0,pan_subscriber,0.3\n6.0,pan_subscriber,nan\n6.1,pan_subscriber,inf\n", 7.0)
    assert statistics["setpoints_dropped"] == 2
    assert statistics["enabled"] is True
    assert float(rows[-1]["inputs.setpoint_pan"]) == 0.3
    assert abs(float(rows[-1]["plant.outputs.angle_pan"]) - 0.3) < 0.02


def test_overruns_in_a_row_disable_and_latch(jiwy: Path) -> None:
    stalls = "".join(f"{5 + 0.001 * i:.3f},$stall,0.0015\n" for i in range(60))
    rows, statistics = simulate(jiwy, stalls, 6.0)
    assert statistics["fault"] == "overrun"
    assert statistics["enabled"] is False
    assert float(rows[-1]["plant.inputs.duty_pan"]) == 0


def test_real_time(jiwy: Path) -> None:
    done = subprocess.run(
        [jiwy / "jiwy_host", "--realtime", "--duration", "2", "--statistics", "rt.json"],
        cwd=jiwy,
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stderr
    statistics = json.loads((jiwy / "rt.json").read_text())
    assert statistics["cycles"] + statistics["missed"] == 2000
    assert statistics["scheduler"] in ("SCHED_FIFO", "SCHED_OTHER")
    assert 0 < statistics["lateness_mean"] <= statistics["lateness_p99"] <= statistics["lateness_max"]
    assert "jitter" in done.stdout or "lateness" in done.stdout


def test_relbot_in_cpp(tmp_path: Path) -> None:
    if shutil.which("c++") is None:
        pytest.skip("no C++ compiler")
    output = run(
        f"cmake -S examples/relbot -B {tmp_path} -DPython3_EXECUTABLE={sys.executable}"
        f" && cmake --build {tmp_path} --target tracking"
    )
    assert re.search(r"all \d+ limits of the scenario hold", output)
