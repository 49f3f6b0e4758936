# SPDX-License-Identifier: Apache-2.0
"""``epg record`` on a real DDS network: its files contain the published values, to the last bit."""

from __future__ import annotations

import csv
import json
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest

pytest.importorskip("tests.ros2.packages", exc_type=ImportError)

from cyclonedds.core import Policy, Qos
from cyclonedds.domain import DomainParticipant
from cyclonedds.pub import DataWriter
from cyclonedds.topic import Topic
from cyclonedds.util import duration

from epg.cli.main import main
from epg.ros import dds_types as msg
from tests.ros2.network import Network

from .description import topic, write_description

ROOT = Path(__file__).resolve().parent.parent.parent
RELIABLE = Qos(Policy.Reliability.Reliable(duration(seconds=1)), Policy.History.KeepLast(10))
BEST_EFFORT = Qos(Policy.Reliability.BestEffort, Policy.History.KeepLast(10))


def header() -> msg.Header:
    return msg.Header(msg.Time(1, 2), "")


MESSAGES: dict[str, tuple[Callable[[int], Any], dict[str, Callable[[int], float]]]] = {
    "std_msgs/msg/Float64": (lambda n: msg.Float64(n / 3), {"": lambda n: n / 3}),
    "std_msgs/msg/Float32": (lambda n: msg.Float32(n / 4), {"": lambda n: n / 4}),
    "std_msgs/msg/Int32": (lambda n: msg.Int32(-n), {"": lambda n: -n}),
    "std_msgs/msg/Bool": (lambda n: msg.Bool(n % 2 == 1), {"": lambda n: n % 2}),
    "std_msgs/msg/Float64MultiArray": (
        # The first value belongs to another program, and the user does not record "second".
        lambda n: msg.Float64MultiArray(msg.MultiArrayLayout([], 1), [-1.0, n, 0.0, n / 7]),
        {"first": lambda n: n, "third": lambda n: n / 7},
    ),
    "sensor_msgs/msg/JointState": (  # in another order than the target's
        lambda n: msg.JointState(header(), ["tilt", "pan"], [n, n / 7], [], [n / 9, n / 11]),
        {"pan.position": lambda n: n / 7, "pan.effort": lambda n: n / 11, "tilt.position": lambda n: n},
    ),
    "geometry_msgs/msg/Twist": (
        lambda n: msg.Twist(msg.Vector3(n / 7, 0, 0), msg.Vector3(0, 0, n / 9)),
        {"linear_x": lambda n: n / 7, "angular_z": lambda n: n / 9},
    ),
    "geometry_msgs/msg/TwistStamped": (
        lambda n: msg.TwistStamped(header(), msg.Twist(msg.Vector3(0, n / 7, 0), msg.Vector3(0, 0, 0))),
        {"linear_y": lambda n: n / 7},
    ),
}


@contextmanager
def publishing(net: Network, topics: dict[str, str], qos: Qos = RELIABLE) -> Iterator[None]:
    """Publishes messages 1, 2, 3 ... every 10 ms on each topic (DDS name: type) during the block."""
    participant = DomainParticipant(net.domain)
    writers = {n: DataWriter(participant, Topic(participant, n, msg.TYPES[t]), qos=qos) for n, t in topics.items()}
    stop = threading.Event()

    def publish() -> None:
        number = 0
        while not stop.wait(0.01):
            number += 1
            for name, type in topics.items():
                writers[name].write(MESSAGES[type][0](number))

    thread = threading.Thread(target=publish)
    thread.start()
    try:
        yield
    finally:
        stop.set()
        thread.join()


def rows(path: Path) -> list[tuple[float, str, float]]:
    with path.open(encoding="utf-8", newline="") as file:
        lines = list(csv.reader(file))
    assert lines[0] == ["time", "topic", "value"]
    return [(float(time), name, float(value)) for time, name, value in lines[1:]]


def record(*options: str | Path) -> int:
    return main(["record", *map(str, options)])


def test_every_type(net: Network, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    topics = {type.rsplit("/", 1)[1].lower(): type for type in MESSAGES}
    described = [
        topic(
            name,
            type,
            values=[f"{name}/{field}" if field else name for field in MESSAGES[type][1]],
            elements=["first", "second", "third"],
        )
        for name, type in topics.items()
    ]
    robot = write_description(tmp_path / "robot.json", namespace="/cell", publications=described)
    with publishing(net, {f"rt/cell/{name}": type for name, type in topics.items()}):
        assert record(robot, "--output", tmp_path / "run", "--duration", "1.5") == 0
    assert capsys.readouterr().err == ""
    recorded = rows(tmp_path / "run/topics.csv")
    assert [time for time, _, _ in recorded] == sorted(time for time, _, _ in recorded)
    for name, type in topics.items():
        fields = MESSAGES[type][1]
        columns = {f: [v for _, n, v in recorded if n == (f"{name}/{f}" if f else name)] for f in fields}
        lengths = {len(values) for values in columns.values()}
        assert len(lengths) == 1 and lengths.pop() > 30, name
        if type == "std_msgs/msg/Bool":
            assert all(one + other == 1.0 for one, other in zip(columns[""], columns[""][1:])), "they alternate"
            continue
        field, value = next(iter(fields.items()))
        first = next(n for n in range(1, 2000) if float(value(n)) == pytest.approx(columns[field][0], abs=1e-12))
        for field, value in fields.items():
            expected = [float(value(n)) for n in range(first, first + len(columns[field]))]
            assert columns[field] == expected, f"{name} {field}: nothing lost, nothing changed"


def test_setpoints_and_topics_have_files_of_their_own(
    net: Network, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    robot = write_description(tmp_path / "robot.json")
    names = {"rt/pan_subscriber": "std_msgs/msg/Float64", "rt/pan_publisher": "std_msgs/msg/Float64"}
    with publishing(net, names):
        assert record(robot, "--output", tmp_path, "--duration", "1", "--json") == 0
    assert {name for _, name, _ in rows(tmp_path / "setpoints.csv")} == {"pan_subscriber"}
    times = [time for time, name, _ in rows(tmp_path / "topics.csv") if name == "pan_publisher"]
    assert times[0] >= 0.0 and times[-1] <= 1.1
    heard = json.loads(capsys.readouterr().out)["topics"]
    assert [(t["topic"], t["messages"] > 20, 40 < t["rate"] < 110) for t in heard] == [
        ("/pan_subscriber", True, True),
        ("/pan_publisher", True, True),
    ]


def test_a_setpoint_at_best_effort_is_recorded_too(net: Network, tmp_path: Path) -> None:
    robot = write_description(tmp_path / "robot.json")
    with publishing(net, {"rt/pan_subscriber": "std_msgs/msg/Float64"}, BEST_EFFORT):
        assert record(robot, "--output", tmp_path, "--duration", "1") == 0
    assert len(rows(tmp_path / "setpoints.csv")) > 20


def test_a_qos_that_does_not_fit_is_told(net: Network, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    robot = write_description(tmp_path / "robot.json")
    with publishing(net, {"rt/pan_publisher": "std_msgs/msg/Float64"}, BEST_EFFORT):
        assert record(robot, "--output", tmp_path, "--duration", "1") == 0
    assert "no message was received on /pan_publisher: its publisher is best effort" in capsys.readouterr().err


def test_names_of_a_board(net: Network, tmp_path: Path) -> None:
    robot = write_description(tmp_path / "robot.json", namespace="/robot_$serial")
    names = {f"rt/{space}/pan_publisher": "std_msgs/msg/Float64" for space in ("robot_E6614103E72B8C2F", "arm")}
    with publishing(net, names):
        assert record(robot, "--output", tmp_path / "a", "--duration", "0.7", "--board", "e6614103e72b8c2f") == 0
        assert record(robot, "--output", tmp_path / "b", "--duration", "0.7", "--namespace", "arm") == 0
    assert rows(tmp_path / "a/topics.csv")
    assert rows(tmp_path / "b/topics.csv")


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_an_interrupted_recording_is_complete(net: Network, tmp_path: Path, number: signal.Signals) -> None:
    robot = write_description(tmp_path / "robot.json")
    command = [sys.executable, str(ROOT / "epg"), "record", str(robot), "--output", str(tmp_path)]
    with publishing(net, {"rt/pan_publisher": "std_msgs/msg/Float64"}):
        process = subprocess.Popen(
            command, env=net.environment, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
        )
        deadline = time.monotonic() + 20.0
        topics = tmp_path / "topics.csv"
        while not topics.is_file() and time.monotonic() < deadline:
            time.sleep(0.02)
        time.sleep(1.5)
        process.send_signal(number)
        out, err = process.communicate(timeout=20)
    assert (process.returncode, err) == (0, "")
    recorded = rows(topics)
    assert len(recorded) > 20
    assert f"/pan_publisher   std_msgs/msg/Float64  {len(recorded)} " in out


def test_rclpy_hears_the_same(net: Network, tmp_path: Path) -> None:
    pytest.importorskip("rclpy", reason="ROS 2 is not sourced: install ROS 2 Jazzy and '. /opt/ros/jazzy/setup.bash'")
    robot = write_description(tmp_path / "robot.json")
    with publishing(net, {"rt/pan_publisher": "std_msgs/msg/Float64"}):
        assert record(robot, "--output", tmp_path, "--duration", "2", "--through", "rclpy") == 0
    values = [round(3 * value) for _, _, value in rows(tmp_path / "topics.csv")]
    assert len(values) > 20
    assert values == list(range(values[0], values[0] + len(values)))
