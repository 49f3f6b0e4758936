# SPDX-License-Identifier: Apache-2.0
"""A robot's run, recorded over DDS, shows the same motion as the robot's own trace."""

from __future__ import annotations

import json
import math
import threading
import time
from pathlib import Path

import pytest

pytest.importorskip("tests.ros2.packages", exc_type=ImportError)

from cyclonedds.domain import DomainParticipant
from cyclonedds.pub import DataWriter
from cyclonedds.topic import Topic

from epg import bootstrap
from epg.cli.main import main
from epg.ros.dds_types import Float64
from tests.emulator.toolchain import Missing
from tests.ros2.build import build_robots
from tests.ros2.network import Network, running

from .test_record import RELIABLE, rows

SETPOINTS = [0.3 * math.sin(0.2 * n) for n in range(60)]


@pytest.fixture(scope="module")
def jiwy(tmp_path_factory: pytest.TempPathFactory) -> Path:
    try:
        return build_robots(tmp_path_factory.mktemp("robots"), "-O2")("jiwy")
    except Missing as problem:
        pytest.skip(str(problem))


def test_jiwy(jiwy: Path, net: Network, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    bootstrap.ensure("plot")
    description = jiwy.parent / "epg/jiwy/jiwy.json"
    trace = tmp_path / "trace.csv"
    participant = DomainParticipant(net.domain)
    writer = DataWriter(participant, Topic(participant, "rt/robot_host/pan_subscriber", Float64), qos=RELIABLE)

    def command() -> None:
        time.sleep(3.0)
        for setpoint in SETPOINTS:
            writer.write(Float64(setpoint))
            time.sleep(0.033)

    robot = net.run(jiwy, "--quiet", "--duration", "8", "--trace", str(trace))
    thread = threading.Thread(target=command)
    thread.start()
    with running([robot]):
        options = ["--output", str(tmp_path / "run"), "--duration", "6.5", "--board", "host"]
        assert main(["record", str(description), *options]) == 0
        assert capsys.readouterr().err == ""
        assert robot.wait(timeout=30) == 0
    thread.join()
    assert [value for _, name, value in rows(tmp_path / "run/setpoints.csv")] == SETPOINTS

    # homing moves both axes, so that there is a motion to compare
    signals = [f"{axis}_publisher=outputs.{axis}_logging" for axis in ("pan", "tilt")]
    picture = ["--output", str(tmp_path / "run.png"), "--json"]
    chosen = [word for signal in signals for word in ("--signal", signal)]
    assert main(["plot", str(tmp_path / "run"), "--against", str(trace), *chosen, *picture]) == 0
    compared = {s["signal"]: s for s in json.loads(capsys.readouterr().out)["signals"]}
    for axis in ("pan", "tilt"):
        recorded = [value for _, name, value in rows(tmp_path / "run/topics.csv") if name == f"{axis}_publisher"]
        assert len(recorded) > 0.8 * 6.5 / 0.033
        assert max(recorded) - min(recorded) > 0.1
        found = compared[f"{axis}_publisher"]
        assert found["rms"] < 0.05 * (max(recorded) - min(recorded)), "published every 33 ms, drawn straight between"
        assert abs(found["lag"]) < 0.033
