# SPDX-License-Identifier: Apache-2.0
"""``epg record`` on a real DDS network: its files contain the published values, to the last bit."""

from __future__ import annotations

import csv
import json
import shutil
import signal
import struct
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest

pytest.importorskip("tests.doubles.ros2_peer.packages", exc_type=ImportError)
pytest.importorskip("rosbags", reason="rosbags is not installed: pip install -r epg/generator/lock/test_all.txt")
pytest.importorskip("mcap", reason="mcap is not installed: pip install mcap")

from cyclonedds.core import Policy, Qos
from cyclonedds.domain import DomainParticipant
from cyclonedds.pub import DataWriter
from cyclonedds.topic import Topic
from cyclonedds.util import duration
from mcap.reader import make_reader

from epg.cli.main import main
from tests.doubles.ros2_peer.definitions import type_hash
from tests.ros2.network import Network
from tests.waiting import until

from .description import topic, write_description
from .types import TYPES, msg

ROOT = Path(__file__).resolve().parent.parent.parent
RELIABLE = Qos(Policy.Reliability.Reliable(duration(seconds=1)), Policy.History.KeepLast(10))
BEST_EFFORT = Qos(Policy.Reliability.BestEffort, Policy.History.KeepLast(10))


def header() -> Any:
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
    writers = {n: DataWriter(participant, Topic(participant, n, TYPES[t]), qos=qos) for n, t in topics.items()}
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


SYSTEM = """version: 1
system: two_jiwys
targets:
  leader: {tcf: rpi_pico_freertos_jiwy, model: model, bindings: jiwy.bindings.yaml}
  follower: {tcf: nucleo_h743zi_freertos_jiwy, model: model, bindings: jiwy.bindings.yaml, count: 2}
connections:
  - {from: leader/pan_publisher, to: follower/pan_subscriber}
  - {from: leader/tilt_publisher, to: follower/tilt_subscriber, qos: reliable}
world: {sends: [leader/pan_subscriber, leader/tilt_subscriber]}
"""


def test_a_system(net: Network, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Each topic of the system is recorded once, also if several targets receive it."""
    shutil.copytree(ROOT / "examples/jiwy/model", tmp_path / "model")
    shutil.copy(ROOT / "examples/jiwy/jiwy.bindings.yaml", tmp_path)
    system = tmp_path / "two_jiwys.system.yaml"
    system.write_text(SYSTEM, encoding="utf-8")
    sent = [
        f"{target}/{axis}_publisher" for target in ("leader", "follower_1", "follower_2") for axis in ("pan", "tilt")
    ]
    asked = [f"leader/{axis}_subscriber" for axis in ("pan", "tilt")]
    with publishing(net, {f"rt/two_jiwys/{name}": "std_msgs/msg/Float64" for name in (*sent, *asked)}):
        assert record(system, "--output", tmp_path / "run", "--duration", "1.5", "--mcap") == 0
    assert capsys.readouterr().err == ""
    connected = [f"/two_jiwys/{name}" for name in sent[:2]]  # the names that the simulation of the system writes
    for file, names in (("topics.csv", [*connected, *sent[2:]]), ("setpoints.csv", [f"/two_jiwys/{n}" for n in asked])):
        recorded = rows(tmp_path / "run" / file)
        assert {name for _, name, _ in recorded} == set(names)
        for name in names:
            values = [value for _, other, value in recorded if other == name]
            first = round(3 * values[0])
            assert len(values) > 30 and values == [number / 3 for number in range(first, first + len(values))]
    with (tmp_path / "run/recording.mcap").open("rb") as file:
        summary = make_reader(file).get_summary()
    assert summary and {channel.topic for channel in summary.channels.values()} == {
        f"/two_jiwys/{name}" for name in (*sent, *asked)
    }


def stamped(clock: Callable[[], int]) -> tuple[str, Callable[[int], Any]]:
    """JointState messages with the time that ``clock`` returns in nanoseconds."""

    def message(number: int) -> Any:
        seconds, nanoseconds = divmod(clock(), 1_000_000_000)
        return msg.JointState(msg.Header(msg.Time(seconds, nanoseconds), "base"), ["pan"], [number / 7], [], [])

    return "sensor_msgs/msg/JointState", message


def test_mcap_is_read_by_another_reader(net: Network, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Every message is in the file, with the values that the CSV files have, and with its definition."""
    from rosbags.highlevel import AnyReader
    from rosbags.interfaces import QosReliability

    topics = {type.rsplit("/", 1)[1].lower(): type for type in MESSAGES}
    described = [
        topic(
            name,
            type,
            values=[f"{name}/{field}" if field else name for field in MESSAGES[type][1]],
            elements=["first", "second", "third"],
            qos="best_effort" if name == "bool" else "reliable",
        )
        for name, type in topics.items()
    ]
    robot = write_description(tmp_path / "robot.json", namespace="/cell", subscriptions=(), publications=described)
    with publishing(net, {f"rt/cell/{name}": type for name, type in topics.items()}):
        assert record(robot, "--output", tmp_path / "run", "--duration", "1.5", "--mcap") == 0
    (tmp_path / "after").touch()
    recorded = rows(tmp_path / "run/topics.csv")
    with AnyReader([tmp_path / "run/recording.mcap"]) as reader:
        assert {c.topic: c.msgtype for c in reader.connections} == {f"/cell/{n}": t for n, t in topics.items()}
        qos = {c.topic: c.ext.offered_qos_profiles[0].reliability for c in reader.connections}
        assert {t for t, found in qos.items() if found == QosReliability.BEST_EFFORT} == {"/cell/bool"}
        messages = [(c.topic, log, reader.deserialize(raw, c.msgtype)) for c, log, raw in reader.messages()]
    for name, type in topics.items():
        found = [message for other, _, message in messages if other == f"/cell/{name}"]
        field = next(iter(MESSAGES[type][1]))
        in_csv = [value for _, other, value in recorded if other == (f"{name}/{field}" if field else name)]
        values = {
            "float64multiarray": lambda m: m.data[1],
            "jointstate": lambda m: m.position[1],
            "twist": lambda m: m.linear.x,
            "twiststamped": lambda m: m.twist.linear.y,
        }.get(name, lambda m: m.data)
        assert len(found) > 30 and [float(values(message)) for message in found] == in_csv
    # The stamps are 1 s after 1970: they belong to another clock than the arrival.
    began, ended = (1e9 * (tmp_path / name).stat().st_mtime for name in ("robot.json", "after"))
    assert all(began <= log <= ended for _, log, _ in messages)


def test_the_log_time_is_the_time_of_the_control_cycle(net: Network, tmp_path: Path) -> None:
    from mcap.reader import make_reader

    robot = write_description(
        tmp_path / "robot.json",
        subscriptions=(),
        publications=[topic("joints", "sensor_msgs/msg/JointState", values=["joints/pan.position"])],
    )
    late = 40_000_000
    type, message = stamped(lambda: time.time_ns() - late)  # the stamps of a board whose clock is set
    participant = DomainParticipant(net.domain)
    writer = DataWriter(participant, Topic(participant, "rt/joints", msg.JointState), qos=RELIABLE)
    stop = threading.Event()

    def publish() -> None:
        while not stop.wait(0.01):
            writer.write(message(1))

    thread = threading.Thread(target=publish)
    thread.start()
    try:
        assert record(robot, "--output", tmp_path, "--duration", "1", "--mcap") == 0
    finally:
        stop.set()
        thread.join()
    with (tmp_path / "recording.mcap").open("rb") as file:
        reader = make_reader(file, validate_crcs=True)
        assert reader.get_header().profile == "ros2"
        summary = reader.get_summary()
        assert summary and summary.chunk_indexes and summary.statistics
        (schema,) = summary.schemas.values()
        assert (schema.name, schema.encoding) == (type, "ros2msg")
        (channel,) = (channel for channel in summary.channels.values())
        assert channel.message_encoding == "cdr"
        assert channel.metadata["topic_type_hash"] == type_hash(type)
        found = [m for _, _, m in reader.iter_messages()]
    assert len(found) > 20 and summary.statistics.message_count == len(found)
    for one in found:
        seconds, nanoseconds = (int.from_bytes(one.data[at : at + 4], "little") for at in (4, 8))
        assert one.log_time == 1_000_000_000 * seconds + nanoseconds
        assert one.publish_time >= one.log_time + late, "it was sent after the control cycle"


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


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
def test_an_interrupted_recording_is_complete(net: Network, tmp_path: Path, number: signal.Signals) -> None:
    robot = write_description(tmp_path / "robot.json")
    command = [sys.executable, str(ROOT / "epg"), "record", str(robot), "--output", str(tmp_path), "--mcap"]
    with publishing(net, {"rt/pan_publisher": "std_msgs/msg/Float64"}):
        process = subprocess.Popen(
            command, env=net.environment, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
        )
        topics = tmp_path / "topics.csv"
        until(topics.is_file)
        time.sleep(1.5)  # rows reach the file later
        process.send_signal(number)
        out, err = process.communicate(timeout=20)
    assert (process.returncode, err) == (0, "")
    recorded = rows(topics)
    assert len(recorded) > 20
    assert f"/pan_publisher   std_msgs/msg/Float64  {len(recorded)} " in out
    with (tmp_path / "recording.mcap").open("rb") as file:
        summary = make_reader(file).get_summary()
    assert summary and summary.statistics and summary.statistics.message_count == len(recorded)


def test_rclpy_without_the_message(
    net: Network, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    pytest.importorskip("rclpy", reason="ROS 2 is not sourced: install ROS 2 Jazzy and '. /opt/ros/jazzy/setup.bash'")
    monkeypatch.setenv("RMW_IMPLEMENTATION", "rmw_cyclonedds_cpp")  # a process loads one implementation, once
    robot = write_description(
        tmp_path / "robot.json", publications=[topic("own", "robot_msgs/msg/Own", values=["own/x"])]
    )
    data = json.loads(robot.read_text(encoding="utf-8")) | {"messages": {"robot_msgs/msg/Own": "float64 x\n"}}
    robot.write_text(json.dumps(data), encoding="utf-8")
    assert record(robot, "--output", tmp_path, "--duration", "1", "--through", "rclpy") == 4
    assert "ROS 2 does not have the message robot_msgs/msg/Own" in capsys.readouterr().err


def test_rclpy_hears_the_same(net: Network, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("rclpy", reason="ROS 2 is not sourced: install ROS 2 Jazzy and '. /opt/ros/jazzy/setup.bash'")
    monkeypatch.setenv("RMW_IMPLEMENTATION", "rmw_cyclonedds_cpp")  # Fast DDS does not support the tag of `net`
    robot = write_description(tmp_path / "robot.json")
    with publishing(net, {"rt/pan_publisher": "std_msgs/msg/Float64"}):
        assert record(robot, "--output", tmp_path, "--duration", "2", "--through", "rclpy", "--mcap") == 0
    with (tmp_path / "recording.mcap").open("rb") as file:
        sent = [message for _, _, message in make_reader(file).iter_messages()]
    assert [struct.unpack("<d", message.data[4:])[0] for message in sent] == [
        value for _, _, value in rows(tmp_path / "topics.csv")
    ]
    assert all(abs(message.publish_time - message.log_time) < 10**9 for message in sent)
    values = [round(3 * value) for _, _, value in rows(tmp_path / "topics.csv")]
    assert len(values) > 20
    assert values == list(range(values[0], values[0] + len(values)))
