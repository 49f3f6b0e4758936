# SPDX-License-Identifier: Apache-2.0
"""The communication side alone: the setpoints that it hands to the control side, and their times."""

from __future__ import annotations

import subprocess
from pathlib import Path

import pytest

from .program import HOST, PROGRAMS, compile_program, rows


@pytest.fixture(scope="module")
def delivery(tmp_path_factory: pytest.TempPathFactory) -> Path:
    parts = ("files/communication", "files/files", "files/number", "files/setpoints", "port/port")
    sources = [PROGRAMS / "delivery.c", *(HOST / "src" / f"{part}.c" for part in parts)]
    return compile_program(tmp_path_factory.mktemp("delivery") / "delivery", sources)


def deliver(program: Path, folder: Path, events: str, mode: str, end: float, *times: float) -> list[list[str]]:
    """The output of each call; first the header of the topics."""
    (folder / "in.csv").write_text(events)
    command = [str(program), str(folder / "in.csv"), mode, str(end), *map(str, times)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (0, "")
    calls: list[list[str]] = [[]]
    for line in done.stdout.splitlines():
        if line.startswith("-- "):
            calls.append([])
        else:
            calls[-1].append(line)
    assert calls[0] == ["time,topic,value"]
    return calls[1:]


def test_setpoints_of_one_moment_are_published_together(delivery: Path, tmp_path: Path) -> None:
    events = rows("0.001,a,1", "0.001,$enable,1", "0.001,b,2", "0.001,a,nan", "0.002,b,3", "0.003,a,inf")
    assert deliver(delivery, tmp_path, events, "simulated", 9, 0.5, 1, 5) == [
        ["0,p,1.5"],
        [
            "setpoint 0 = 1 at 1.000 ms",
            "enable",
            "setpoint 1 = 2 at 1.000 ms, published",
            "setpoint 0 = nan at 1.000 ms",
        ],
        ["setpoint 1 = 3 at 2.000 ms, published", "setpoint 0 = inf at 3.000 ms"],
    ]


def test_simulated_time_keeps_the_order_of_time(delivery: Path, tmp_path: Path) -> None:
    events = rows("0.01,a,1", "0.015,b,2", "0.03,a,3")
    assert deliver(delivery, tmp_path, events, "simulated", 100, 0, 10, 25, 30) == [
        [],  # the publication at 0 waits for the cycle at 0
        ["0,p,1.5", "setpoint 0 = 1 at 10.000 ms, published"],
        ["0.01,p,1.5", "setpoint 1 = 2 at 15.000 ms, published", "0.02,p,1.5"],
        ["setpoint 0 = 3 at 30.000 ms, published"],
    ]


@pytest.mark.parametrize("mode", ["simulated", "realtime"])
def test_nothing_happens_from_the_end_on(delivery: Path, tmp_path: Path, mode: str) -> None:
    events = rows("0.004,a,1", "0.005,b,2", "0.02,a,3")
    calls = deliver(delivery, tmp_path, events, mode, 5, 0.5, 4.5, 5, 50)
    assert [len(call) for call in calls] == [1, 1, 0, 0]


def test_real_time_publishes_once_and_stays_on_schedule(delivery: Path, tmp_path: Path) -> None:
    events = rows("0.001,a,1", "0.002,b,2", "0.05,a,3")
    assert deliver(delivery, tmp_path, events, "realtime", 100, 0.1, 9, 10.2, 19.9, 20, 47, 49.9, 50.1, 60) == [
        ["0.0001,p,1.5"],
        # Late: both have arrived by then, and count as received now.
        ["setpoint 0 = 1 at 9.000 ms, published", "setpoint 1 = 2 at 9.000 ms, published"],
        ["0.0102,p,1.5"],
        [],
        ["0.02,p,1.5"],
        ["0.047,p,1.5"],  # one message instead of those of 30 and 40 ms
        [],
        ["setpoint 0 = 3 at 50.100 ms, published", "0.0501,p,1.5"],
        ["0.06,p,1.5"],
    ]
