# SPDX-License-Identifier: Apache-2.0
"""A robot's run, recorded over DDS, shows the same motion as the robot's own trace."""

from __future__ import annotations

import json
import math
import threading
import time
from pathlib import Path

import pytest

pytest.importorskip("tests.doubles.ros2_peer.packages", exc_type=ImportError)
pytest.importorskip("rosbags", reason="rosbags is not installed: pip install -r epg/generator/lock/test_all.txt")

from cyclonedds.domain import DomainParticipant
from cyclonedds.pub import DataWriter
from cyclonedds.topic import Topic
from rosbags.highlevel import AnyReader

from epg.cli.main import main
from epg.generator import bootstrap
from epg.generator.messages.library import Library
from epg.ros.dds_types import dds_type
from tests.doubles.toolchain import Missing
from tests.ros2.build import build_robots
from tests.ros2.network import Network, running
from tests.waiting import until

from .test_record import RELIABLE, rows
from .types import msg

SETPOINTS = [0.3 * math.sin(0.2 * n) for n in range(60)]


@pytest.fixture(scope="module")
def jiwy(tmp_path_factory: pytest.TempPathFactory) -> Path:
    try:
        return build_robots(tmp_path_factory.mktemp("robots"), "-O2")("jiwy")
    except Missing as problem:
        pytest.skip(str(problem))


def test_messages_of_any_type(net: Network, jiwy: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """An Imu, and a message of the user's own whose definition only the description of the target has."""
    sensors = build_robots(jiwy.parent, "-O2")("sensors")
    description = jiwy.parent / "epg/sensors/sensors.json"
    data = json.loads(description.read_text(encoding="utf-8"))
    assert set(data["messages"]) == {"robot_msgs/msg/Gripper", "sensor_msgs/msg/Imu"}
    library = Library()
    assert library.add("robot_msgs/msg/Gripper", data["messages"]["robot_msgs/msg/Gripper"])
    gripper = dds_type(library, "robot_msgs/msg/Gripper")
    participant = DomainParticipant(net.domain)
    writer = DataWriter(participant, Topic(participant, "rt/robot_host/gripper", gripper), qos=RELIABLE)
    header = dds_type(library, "std_msgs/msg/Header")(dds_type(library, "builtin_interfaces/msg/Time")(1, 2), "x")

    def command() -> None:
        until((tmp_path / "run/topics.csv").is_file)
        until(lambda: len(writer.get_matched_subscriptions()) == 2)  # the robot and the recorder
        for number in range(20):
            writer.write(gripper(header, True, 1, [0.0, number / 100, 0.0], -7, "left", number / 50))
            time.sleep(0.02)  # the period of the setpoints

    robot = net.run(sensors, "--quiet", "--duration", "6", "--serial", "host")
    thread = threading.Thread(target=command)
    thread.start()
    with running([robot]):
        options = ["--output", str(tmp_path / "run"), "--duration", "4.5", "--board", "host", "--mcap"]
        assert main(["record", str(description), *options]) == 0
        assert capsys.readouterr().err == ""
        assert robot.wait(timeout=30) == 0
    thread.join()
    setpoints = rows(tmp_path / "run/setpoints.csv")
    assert [value for _, name, value in setpoints if name == "gripper/width"] == [n / 50 for n in range(20)]
    turned = [value for _, name, value in rows(tmp_path / "run/topics.csv") if name == "imu/data/angular_velocity.z"]
    with AnyReader([tmp_path / "run/recording.mcap"]) as reader:
        found = [(c.msgtype, reader.deserialize(raw, c.msgtype)) for c, _, raw in reader.messages()]
    sent = [message for type, message in found if type == "sensor_msgs/msg/Imu"]
    assert len(sent) > 60 and [message.angular_velocity.z for message in sent] == turned
    forces = [message.force[1] for type, message in found if type == "robot_msgs/msg/Gripper"]
    assert forces == pytest.approx([n / 100 for n in range(20)], abs=1e-7)
    output = ["--board", "host", "--plotjuggler", "--foxglove", "--output", str(tmp_path)]
    assert main(["describe", str(description), *output]) == 0
    layout = json.loads((tmp_path / "sensors.foxglove.json").read_text(encoding="utf-8"))
    paths = [path["value"] for panel in layout["configById"].values() for path in panel["paths"]]
    assert "/robot_host/gripper.force[1]" in paths and "/robot_host/imu/data.angular_velocity.z" in paths


def test_jiwy(jiwy: Path, net: Network, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    bootstrap.ensure("plot")
    description = jiwy.parent / "epg/jiwy/jiwy.json"
    trace = tmp_path / "trace.csv"
    participant = DomainParticipant(net.domain)
    writer = DataWriter(participant, Topic(participant, "rt/robot_host/pan_subscriber", msg.Float64), qos=RELIABLE)

    def command() -> None:
        until((tmp_path / "run/topics.csv").is_file)
        until(lambda: len(writer.get_matched_subscriptions()) == 2)  # the robot and the recorder
        for setpoint in SETPOINTS:
            writer.write(msg.Float64(setpoint))
            time.sleep(0.033)  # the period of the setpoints

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
