# SPDX-License-Identifier: Apache-2.0
"""Simulated time at a multiple of real time, with a middleware.

Tests of /clock: tests/ros2/test_dds_node.py, tests/middlewares/xrce/test_host_options.py.
"""

from __future__ import annotations

import signal
import subprocess
from pathlib import Path

import pytest

from .program import Program, rows

NOTE = "motor: simulated time at 5 times real time: this run is not repeatable\n"


def test_without_messages_it_is_the_simulated_run(connected_motor: Program, tmp_path: Path) -> None:
    events = rows("0.05,motor_setpoint,1", "0.1,$stall,0.0155", "0.2,motor_enable,0", "0.25,$enable,1")
    plain = connected_motor.run_good(tmp_path / "plain", 0.5, events)
    paced = connected_motor.run(tmp_path / "paced", 0.5, events, "--pace", "5")
    assert (paced.status, paced.stderr) == (0, NOTE)
    assert paced.stdout.startswith("connected\nmotor: 0.500 s simulated, wall time ")
    assert "connected" not in plain.stdout
    for name in ("trace.csv", "topics.csv"):
        assert (paced.folder / name).read_bytes() == (plain.folder / name).read_bytes()
    assert paced.statistics["wall_time"] >= 0.0998, "the last tick is at 0.499 s of simulated time"
    assert (paced.statistics["pace"], paced.statistics["mode"]) == (5, "simulated")
    assert "pace" not in plain.statistics


def test_it_runs_until_it_is_ended(connected_motor: Program) -> None:
    for arguments, status in (["--pace", "2"], 130), (["--pace", "2", "--ros-args"], 0):
        command = [str(connected_motor.path), *arguments]
        with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
            assert process.stdout is not None and process.stdout.readline() == "connected\n"
            process.send_signal(signal.SIGINT)
            output = process.communicate(timeout=30)[0]
            assert process.returncode == status
            assert "s simulated, wall time" in output


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (
            ["--pace", "0"],
            "error: --pace '0' is not a factor from 0.01 to 100\nhint: --pace 1 is as fast as real time\n",
        ),
        (["--pace", "fast"], "error: --pace 'fast' is not a factor from 0.01 to 100\n"),
        (["--pace=nan"], "error: --pace 'nan' is not a factor from 0.01 to 100\n"),
        (["--pace", "1", "--realtime"], "error: --pace and --realtime\n"),
        (["--pace", "1", "--console"], "error: --console without --realtime\n"),
    ],
)
def test_mistakes(connected_motor: Program, options: list[str], message: str) -> None:
    done = subprocess.run(
        [str(connected_motor.path), *options], capture_output=True, text=True, timeout=60, check=False
    )
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr.startswith(message)


def test_a_target_without_a_connection_has_no_pace(motor: Program, tmp_path: Path) -> None:
    run = motor.run(tmp_path, 1, None, "--pace", "1")
    assert run.status == 2
    assert run.stderr.startswith("error: --pace: this target is not a ROS 2 node\n")
