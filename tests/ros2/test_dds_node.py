# SPDX-License-Identifier: Apache-2.0
"""A target with the middleware `dds`, seen by another ROS 2 node: real executables, a peer, the loopback network."""

from __future__ import annotations

import csv
import itertools
import math
import os
import re
import signal
import statistics
import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest

pytest.importorskip("tests.doubles.ros2_peer.packages", exc_type=ImportError)

from cyclonedds.core import Policy
from cyclonedds.util import duration

from tests.doubles.ros2_peer.definitions import type_hash
from tests.doubles.ros2_peer.messages import (
    Bool_,
    Clock_,
    DiagnosticArray_,
    Float64_,
    Float64MultiArray_,
    Gripper_,
    Header_,
    HugeFloat64_,
    Imu_,
    JointState_,
    LongFloat64_,
    MultiArrayDimension_,
    MultiArrayLayout_,
    ShortFloat64_,
    Time_,
    numbers,
)
from tests.doubles.ros2_peer.peer import Endpoint, Peer, Subscription
from tests.ros2.build import Build
from tests.ros2.network import Network, network, running

NODE = "/robot_7/JIWY_node"
ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture(scope="session")
def jiwy(build_checked: Build) -> Path:
    """JIWY whose pan is reliable and whose tilt is best effort, in both directions."""
    return build_checked("jiwy")


@dataclass
class Robot:
    process: subprocess.Popen[str]
    trace: Path

    def end(self) -> str:
        """Ends the program as Ctrl-C does; returns stderr."""
        self.process.send_signal(signal.SIGINT)
        output, errors = self.process.communicate(timeout=30)
        assert self.process.returncode == 130, output + errors
        return errors

    def signal(self, name: str) -> list[float]:
        """A signal of the trace, with one value per control cycle."""
        with self.trace.open(newline="") as file:
            return [float(row[name]) for row in csv.DictReader(file)]


@contextmanager
def robot(net: Network, program: Path, folder: Path, *options: str) -> Iterator[Robot]:
    trace = folder / "trace.csv"
    process = net.run(program, "--quiet", "--serial", "7", "--duration", "60", "--trace", str(trace), *options)
    with running([process]):
        yield Robot(process, trace)


def meet(peer: Peer, node: str = NODE) -> None:
    """Waits until the peer knows the node and all its endpoints."""

    def known() -> bool:
        endpoints = [*peer.graph.publications(), *peer.graph.subscriptions()]
        own = [endpoint for endpoint in endpoints if endpoint.node == node]
        return node in peer.graph.node_names() and peer.graph.knows_all_of(node) and len(own) >= 5

    assert peer.spin_until(known), (peer.graph.node_names(), peer.graph.publications(), peer.graph.subscriptions())


def hear(peer: Peer, subscription: Subscription, count: int) -> bool:
    """True if more than ``count`` messages arrive."""
    return peer.spin_until(lambda: len(subscription.received) > count)


def meet_and_wait(peer: Peer, met: Callable[[], bool]) -> bool:
    """The peer finds the robot's reader before the robot finds the peer's writer: messages sent between are lost."""
    found = peer.spin_until(met)
    peer.spin(0.3)
    return found


def test_the_ros_graph_shows_node_topics_types_and_qos(jiwy: Path, net: Network, tmp_path: Path) -> None:
    """The data that `ros2 node list` and `ros2 topic info --verbose` read."""
    with robot(net, jiwy, tmp_path), Peer(net.domain, "monitor") as peer:
        meet(peer)
        assert peer.graph.node_names() == ["/monitor", NODE]
        number, flag = "std_msgs/msg/Float64", "std_msgs/msg/Bool"

        def endpoint(topic: str, type_: str, reliable: bool) -> Endpoint:
            return Endpoint(f"/robot_7/{topic}", type_, type_hash(type_), reliable, True, NODE)

        values = [e for e in peer.graph.publications() if e.topic.startswith("/robot_7/")]
        assert values == [
            endpoint("pan_publisher", number, True),
            endpoint("tilt_publisher", number, False),
        ]
        assert peer.graph.subscriptions() == [
            endpoint("JIWY_node/enable", flag, True),
            endpoint("pan_subscriber", number, True),
            endpoint("tilt_subscriber", number, False),
        ]


def test_arguments_of_a_launch_file_rename_the_node_and_its_topics(jiwy: Path, net: Network, tmp_path: Path) -> None:
    names = "-r __node:=left -r __ns:=/fleet/a -r pan_publisher:=/pan -r ~/enable:=go -p Pan.PID.kp:=3 --log-level warn"
    with robot(net, jiwy, tmp_path, "--ros-args", *names.split()), Peer(net.domain, "monitor") as peer:
        meet(peer, "/fleet/a/left")
        publications = {e.topic for e in peer.graph.publications() if e.node == "/fleet/a/left"}
        subscriptions = {e.topic for e in peer.graph.subscriptions() if e.node == "/fleet/a/left"}
        assert {"/pan", "/fleet/a/tilt_publisher"} <= publications
        assert {"/fleet/a/go", "/fleet/a/pan_subscriber", "/fleet/a/tilt_subscriber"} <= subscriptions
        pan = peer.subscription("/pan", Float64_)
        assert hear(peer, pan, 3)


def test_simulated_time_at_a_pace_is_on_clock(jiwy: Path, net: Network, tmp_path: Path) -> None:
    """All stamps are simulated time, which begins at 0, and follows real time at the pace."""
    trace = tmp_path / "trace.csv"
    command = [str(jiwy), "--pace", "4", "--serial", "7", "--quiet", "--duration", "1000", "--trace", str(trace)]
    process = subprocess.Popen(command, env=net.environment, stderr=subprocess.PIPE, text=True)
    with running([process]), Peer(net.domain, "monitor") as peer:
        clock = peer.subscription("/clock", Clock_, reliable=False)
        diagnostics = peer.subscription("/diagnostics", DiagnosticArray_)
        pan = peer.publisher("/robot_7/pan_subscriber", Float64_)
        meet(peer)
        clock_endpoint = next(e for e in peer.graph.publications() if e.topic == "/clock")
        assert clock_endpoint.hash == type_hash("rosgraph_msgs/msg/Clock")
        assert not clock_endpoint.reliable
        assert hear(peer, clock, 100) and hear(peer, diagnostics, 2)
        for _ in range(10):  # the robot may discover the writer later than it is discovered
            pan.publish(Float64_(0.1))
            peer.spin(0.033)
        times = [message.clock.sec + message.clock.nanosec * 1e-9 for message in clock.messages]
        assert times == sorted(times) and times[0] < 1000.0
        assert statistics.median(b - a for a, b in itertools.pairwise(times)) == pytest.approx(0.01, abs=0.002)
        stamp = diagnostics.messages[-1].header.stamp
        assert stamp.sec <= times[-1] + 1.0, "not since 1970"
        assert hear(peer, clock, len(clock.received) + 5)
        process.send_signal(signal.SIGINT)
        errors = process.communicate(timeout=30)[1]
    assert errors == "jiwy: simulated time at 4 times real time: this run is not repeatable\n"
    assert Robot(process, trace).signal("inputs.setpoint_pan")[-1] == 0.1


def test_values_come_at_the_communication_period(jiwy: Path, net: Network, tmp_path: Path) -> None:
    with robot(net, jiwy, tmp_path), Peer(net.domain, "monitor") as peer:
        pan = peer.subscription("/robot_7/pan_publisher", Float64_)  # with rclpy's default QoS
        tilt = peer.subscription("/robot_7/tilt_publisher", Float64_, reliable=False)
        assert peer.spin_until(lambda: len(pan.received) > 60 and len(tilt.received) > 60)
        for subscription in (pan, tilt):
            # the first messages may be from before the control loop's start
            sent = [message.sample_info.source_timestamp for message in subscription.messages[2:]]
            intervals = [(after - before) / 1e6 for before, after in itertools.pairwise(sent)]
            assert statistics.median(intervals) == pytest.approx(33.0, abs=0.5)
            assert (sent[-1] - sent[0]) / 1e6 == pytest.approx(33.0 * (len(sent) - 1), abs=20.0)
        assert all(math.isfinite(value) for value in numbers(pan.messages))
        # both values are from one control cycle: pan and tilt are sent together
        assert (
            abs(pan.messages[-1].sample_info.source_timestamp - tilt.messages[-1].sample_info.source_timestamp) < 40e6
        )


def test_a_setpoint_reaches_the_model(jiwy: Path, net: Network, tmp_path: Path) -> None:
    with robot(net, jiwy, tmp_path) as jiwy_robot, Peer(net.domain, "setpoints") as peer:
        pan = peer.publisher("/robot_7/pan_subscriber", Float64_)
        tilt = peer.publisher("/robot_7/tilt_subscriber", Float64_)  # reliable; a best-effort reader also matches
        assert peer.spin_until(lambda: pan.matched == 1 and tilt.matched == 1)
        for _ in range(10):  # the robot may discover the writers later than they discover it
            pan.publish(Float64_(0.1))
            tilt.publish(Float64_(-2.5e-3))
            peer.spin(0.033)
        pan.publish(Float64_(math.nan))  # dropped: the previous value stays
        peer.spin(0.3)
        jiwy_robot.end()
        assert set(jiwy_robot.signal("inputs.setpoint_pan")) == {0.0, 0.1}
        assert set(jiwy_robot.signal("inputs.setpoint_tilt")) == {0.0, -0.0025}
        assert jiwy_robot.signal("inputs.setpoint_pan")[-1] == 0.1


def test_a_best_effort_publisher_gives_nothing_to_a_reliable_reader_and_both_say_so(
    jiwy: Path, net: Network, tmp_path: Path
) -> None:
    with robot(net, jiwy, tmp_path) as jiwy_robot, Peer(net.domain, "monitor") as peer:
        tilt = peer.subscription("/robot_7/tilt_publisher", Float64_)
        pan = peer.subscription("/robot_7/pan_publisher", Float64_)
        assert peer.spin_until(lambda: tilt.refused_for is not None and len(pan.received) > 40)
        assert tilt.refused_for == "RELIABILITY"
        assert pan.refused_for is None
        assert tilt.received == []
        errors = jiwy_robot.end()
        assert "warning: a subscription of /robot_7/tilt_publisher requests another reliability" in errors
        assert "pan_publisher" not in errors


def test_a_reliable_subscription_gets_nothing_from_a_best_effort_writer_and_both_say_so(
    jiwy: Path, net: Network, tmp_path: Path
) -> None:
    with robot(net, jiwy, tmp_path) as jiwy_robot, Peer(net.domain, "setpoints") as peer:
        pan = peer.publisher("/robot_7/pan_subscriber", Float64_, reliable=False)
        tilt = peer.publisher("/robot_7/tilt_subscriber", Float64_, reliable=False)
        assert peer.spin_until(lambda: pan.refused_for is not None and tilt.matched == 1)
        for _ in range(40):
            pan.publish(Float64_(0.5))
            tilt.publish(Float64_(0.5))
            peer.spin(0.033)
        errors = jiwy_robot.end()
        assert pan.refused_for == "RELIABILITY"
        assert "warning: a publication of /robot_7/pan_subscriber offers another reliability" in errors
        assert "tilt_subscriber" not in errors
        assert set(jiwy_robot.signal("inputs.setpoint_pan")) == {0.0}
        assert set(jiwy_robot.signal("inputs.setpoint_tilt")) == {0.0, 0.5}


def test_the_enable_topic_disables_and_enables(jiwy: Path, net: Network, tmp_path: Path) -> None:
    """JIWY homes at its start: its motors turn until it is disabled."""
    with robot(net, jiwy, tmp_path) as jiwy_robot, Peer(net.domain, "operator") as peer:
        enable = peer.publisher("/robot_7/JIWY_node/enable", Bool_)
        pan = peer.subscription("/robot_7/pan_publisher", Float64_)
        assert meet_and_wait(peer, lambda: enable.matched == 1 and len(pan.received) > 3)
        enable.publish(Bool_(False))
        peer.spin(0.5)
        heard = len(pan.received)
        peer.spin(0.5)
        assert len(pan.received) - heard > 8  # positions are still published
        enable.publish(Bool_(True))
        peer.spin(0.3)
        jiwy_robot.end()
        phases = [
            on for on, _ in itertools.groupby(value != 0.0 for value in jiwy_robot.signal("plant.inputs.duty_pan"))
        ]
        assert phases[-3:] in ([True, False, True], [False, True, False])  # outputs are safe again in the last cycle
        assert phases.count(True) == 2


def diagnostics_of(peer: Peer, subscription: Subscription, done: Callable[[dict[str, str]], bool]) -> Any:
    """The first status for which ``done`` is true."""

    def accepted() -> bool:
        return bool(subscription.received) and done(_values(subscription.messages[-1].status[0]))

    assert peer.spin_until(accepted), [m.status for m in subscription.messages[-1:]]
    return subscription.messages[-1].status[0]


def _values(status: Any) -> dict[str, str]:
    return {pair.key: pair.value for pair in status.values}


def test_diagnostics_tell_state_and_statistics(jiwy: Path, net: Network, tmp_path: Path) -> None:
    with robot(net, jiwy, tmp_path), Peer(net.domain, "monitor") as peer:
        told = peer.subscription("/diagnostics", DiagnosticArray_)
        enable = peer.publisher("/robot_7/JIWY_node/enable", Bool_)
        status = diagnostics_of(peer, told, lambda values: int(values["cycles"]) > 500)
        assert (status.message.split(";")[0], status.hardware_id) == ("enabled", "7")
        assert status.level == (0 if status.message == "enabled" else 1)  # a busy computer has overruns
        assert status.name == "robot_7/JIWY_node"
        values = _values(status)
        assert values["fault"] == "none" and values["malformed"] == "0" and len(values["firmware"]) == 16
        stamp = told.messages[-1].header.stamp
        assert abs(stamp.sec - told.messages[-1].sample_info.source_timestamp / 1e9) < 2.0  # the computer's clock
        assert meet_and_wait(peer, lambda: enable.matched == 1)
        enable.publish(Bool_(False))
        peer.spin_until(lambda: told.messages[-1].status[0].message == "disabled")
        assert (told.messages[-1].status[0].level, told.messages[-1].status[0].message) == (1, "disabled")


def test_messages_that_are_none_are_counted_and_do_no_harm(jiwy: Path, net: Network, tmp_path: Path) -> None:
    """Another program uses the name Float64 for another type: of one byte, or of 200 kB (in fragments)."""
    with (
        robot(net, jiwy, tmp_path) as jiwy_robot,
        Peer(net.domain, "stranger") as peer,
        Peer(net.domain, "good") as good,
    ):
        short = peer.raw_publisher("/robot_7/pan_subscriber", ShortFloat64_)
        huge = good.raw_publisher("/robot_7/tilt_subscriber", HugeFloat64_)
        told = peer.subscription("/diagnostics", DiagnosticArray_)
        assert peer.spin_until(lambda: short.matched == 1 and huge.matched == 1)
        for _ in range(20):
            short.writer.write(ShortFloat64_(1))
            peer.spin(0.01)  # a burst would overwrite the oldest of ten
        huge.writer.write(HugeFloat64_(bytes(200_000)))
        diagnostics_of(peer, told, lambda values: int(values["malformed"]) >= 15)  # volatile: the first may be lost
        jiwy_robot.end()
        assert set(jiwy_robot.signal("inputs.setpoint_pan")) == {0.0}
        assert set(jiwy_robot.signal("inputs.setpoint_tilt")) == {0.0}


def test_a_message_in_fragments_is_put_together(jiwy: Path, net: Network, tmp_path: Path) -> None:
    """The bytes after the number are ignored, as in ROS 2."""
    with robot(net, jiwy, tmp_path) as jiwy_robot, Peer(net.domain, "stranger") as peer:
        long = peer.raw_publisher("/robot_7/pan_subscriber", LongFloat64_)
        assert peer.spin_until(lambda: long.matched == 1)
        for value in (0.75, 0.5, 0.25):
            long.writer.write(LongFloat64_(value, bytes(range(200)) * 100))
            peer.spin(0.3)
        jiwy_robot.end()
        assert {0.5, 0.25} <= set(jiwy_robot.signal("inputs.setpoint_pan")) <= {0.0, 0.75, 0.5, 0.25}


def test_a_node_that_ends_is_gone_at_once_and_comes_back(jiwy: Path, net: Network, tmp_path: Path) -> None:
    with Peer(net.domain, "monitor") as peer:
        pan = peer.subscription("/robot_7/pan_publisher", Float64_)
        for _ in range(3):
            heard = len(pan.received)
            with robot(net, jiwy, tmp_path) as jiwy_robot:
                meet(peer)
                assert hear(peer, pan, heard + 10)
                jiwy_robot.end()
                assert peer.spin_until(lambda: NODE not in peer.graph.node_names(), timeout=3.0)


def test_a_peer_that_comes_and_goes_leaves_the_node_as_it_was(jiwy: Path, net: Network, tmp_path: Path) -> None:
    with robot(net, jiwy, tmp_path) as jiwy_robot:
        opened = []
        for _ in range(10):
            with Peer(net.domain, "visitor") as peer:
                setpoint = peer.publisher("/robot_7/pan_subscriber", Float64_)
                assert hear(peer, peer.subscription("/robot_7/pan_publisher", Float64_), 3)
                setpoint.publish(Float64_(0.25))
            opened.append(len(os.listdir(f"/proc/{jiwy_robot.process.pid}/fd")))
        assert len(set(opened)) == 1  # descriptors of files and sockets
        assert jiwy_robot.end() == ""


def cycles_of(peer: Peer, told: Subscription) -> tuple[int, int]:
    """The number of cycles and of missed ticks so far, from the next diagnostics."""
    count = len(told.received)
    assert hear(peer, told, count)
    values = _values(told.messages[-1].status[0])
    return int(values["cycles"]), int(values["missed"])


def test_the_loop_keeps_its_cycles_under_a_flood(jiwy: Path, net: Network, tmp_path: Path) -> None:
    """Setpoints on both topics, as fast as Python sends them."""
    with robot(net, jiwy, tmp_path), Peer(net.domain, "flood") as peer:
        told = peer.subscription("/diagnostics", DiagnosticArray_)
        pan = peer.publisher("/robot_7/pan_subscriber", Float64_)
        tilt = peer.publisher("/robot_7/tilt_subscriber", Float64_, reliable=False)
        assert peer.spin_until(lambda: pan.matched == 1 and tilt.matched == 1 and bool(told.received))
        quiet = cycles_of(peer, told)
        before = cycles_of(peer, told)
        after = before
        sent = 0
        while sum(after) - sum(before) < 2000:
            seen = len(told.received)
            while not peer.spin_until(lambda seen=seen: len(told.received) > seen, 0.0):  # type: ignore[misc]
                sent += 1
                pan.writer.write(Float64_(0.5))
                tilt.writer.write(Float64_(0.25))
            after = cycles_of(peer, told)
        assert sent > 2000
        ticks = sum(after) - sum(before)
        idle_share = (before[1] - quiet[1]) / (sum(before) - sum(quiet))
        assert (after[1] - before[1]) / ticks <= idle_share + 0.05


def test_a_console_beside_it(jiwy: Path, net: Network) -> None:
    """Both work: a setpoint of the console acts, and the node is on the network."""
    command = [str(jiwy), "--realtime", "--console", "--serial", "7"]
    process = subprocess.Popen(
        command, env=net.environment, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )
    with running([process]), Peer(net.domain, "monitor") as peer:
        meet(peer)
        output, errors = process.communicate("pan_subscriber=0.5\nstats\nenable\n", timeout=30)
        assert (process.returncode, errors) == (0, "")
        assert "ok setpoint" in output and "ok enable" in output
        assert re.search(r"connection=running\b", output), output


def test_messages_of_several_values(build_checked: Build, net: Network, tmp_path: Path) -> None:
    """CycloneDDS for Python reads and writes the messages by ROS 2's definitions, not by EPG's code."""
    with robot(net, build_checked("joints"), tmp_path) as jiwy_robot, Peer(net.domain, "rviz") as peer:
        states = peer.subscription("/robot_7/joint_states", JointState_, transient_local=True)
        setpoints = peer.publisher("/robot_7/setpoints", Float64MultiArray_)
        assert meet_and_wait(peer, lambda: setpoints.matched == 1 and len(states.received) > 20)
        dimension = MultiArrayDimension_("axis", 2, 2)
        setpoints.publish(Float64MultiArray_(MultiArrayLayout_([dimension], 0), [0.125, -0.5]))
        peer.spin(0.2)
        setpoints.publish(Float64MultiArray_(MultiArrayLayout_([], 0), [1.0, 2.0, 3.0]))  # one value too many
        peer.spin(0.2)
        own = [e for e in [*peer.graph.publications(), *peer.graph.subscriptions()] if e.node == NODE]
        assert {e.topic for e in own} >= {"/robot_7/joint_states", "/robot_7/setpoints", "/diagnostics"}
        assert [e.hash for e in own] == [type_hash(e.type) for e in own]
        [policies] = [w.qos for w in peer.graph.writers.values() if w.topic_name == "rt/robot_7/joint_states"]
        stated = (
            Policy.Durability.TransientLocal,
            Policy.Deadline(duration(milliseconds=100)),
            Policy.Lifespan(duration(seconds=1)),
        )
        assert all(policy in policies for policy in stated), policies
        jiwy_robot.end()
    last = states.messages[-1]
    assert (last.header.frame_id, last.name, last.velocity, last.effort) == ("base_link", ["pan", "tilt"], [], [])
    stamps = [message.header.stamp.sec + message.header.stamp.nanosec / 1e9 for message in states.messages[2:]]
    intervals = [after - before for before, after in itertools.pairwise(stamps)]
    assert statistics.median(intervals) == pytest.approx(0.033, abs=0.0015), intervals
    assert min(intervals) > 0.0, intervals
    assert abs(stamps[-1] - tmp_path.stat().st_mtime) < 60.0
    positions = set(zip(jiwy_robot.signal("outputs.pan_logging"), jiwy_robot.signal("outputs.tilt_logging")))
    # each message is from one control cycle
    assert {tuple(message.position) for message in states.messages[2:]} <= positions
    assert set(jiwy_robot.signal("inputs.setpoint_pan")) == {0.0, 0.125}
    assert set(jiwy_robot.signal("inputs.setpoint_tilt")) == {0.0, -0.5}


def test_messages_of_any_type(build_checked: Build, net: Network, tmp_path: Path) -> None:
    """An Imu of ROS 2, and a message of the user's own, whose texts have any length on the way in."""
    with robot(net, build_checked("sensors"), tmp_path) as jiwy_robot, Peer(net.domain, "rviz") as peer:
        measured = peer.subscription("/robot_7/imu/data", Imu_)
        gripper = peer.publisher("/robot_7/gripper", Gripper_)
        assert meet_and_wait(peer, lambda: gripper.matched == 1 and len(measured.received) > 20)
        for frame in ("", "a frame with a long name", "x"):
            header = Header_(Time_(1, 2), frame)
            gripper.publish(Gripper_(header, True, 1, [9.0, -0.5, 9.0], -7, frame[:10], 0.125))
            peer.spin(0.1)
        own = [e for e in [*peer.graph.publications(), *peer.graph.subscriptions()] if e.node == NODE]
        types = {e.topic: e.type for e in own}
        assert types["/robot_7/imu/data"] == "sensor_msgs/msg/Imu"
        assert types["/robot_7/gripper"] == "robot_msgs/msg/Gripper"
        assert [e.hash for e in own] == [type_hash(e.type) for e in own]
        jiwy_robot.end()
    last = measured.messages[-1]
    assert last.header.frame_id == "imu_link" and last.orientation.w == 1.0
    assert list(last.orientation_covariance) == [-1.0] + [0.0] * 8
    assert list(last.angular_velocity_covariance) == [0.01, 0, 0, 0, 0.01, 0, 0, 0, 0.01]
    assert abs(last.header.stamp.sec - tmp_path.stat().st_mtime) < 60.0
    positions = set(zip(jiwy_robot.signal("outputs.pan_logging"), jiwy_robot.signal("outputs.tilt_logging")))
    sent = {(message.angular_velocity.z, message.linear_acceleration.x) for message in measured.messages[2:]}
    assert sent <= positions
    assert set(jiwy_robot.signal("inputs.setpoint_pan")) == {0.0, 0.125}
    assert set(jiwy_robot.signal("inputs.setpoint_tilt")) == {0.0, -0.5}


FROZEN = """
import sys
from tests.doubles.ros2_peer.messages import Float64_
from tests.doubles.ros2_peer.peer import Peer

with Peer(int(sys.argv[1]), "frozen") as peer:
    pan = peer.subscription("/robot_7/pan_publisher", Float64_)
    print("up" if peer.spin_until(lambda: len(pan.received) > 3) else "nothing", flush=True)
    peer.spin(60)
"""


def test_a_frozen_reliable_subscriber_holds_nobody_up(jiwy: Path, net: Network, tmp_path: Path) -> None:
    """It does not acknowledge for seconds: the topic is reliable, but the publisher does not wait."""
    command = [sys.executable, "-c", FROZEN, str(net.domain)]
    with robot(net, jiwy, tmp_path), Peer(net.domain, "monitor") as peer:
        frozen = subprocess.Popen(command, cwd=ROOT, env=net.environment, stdout=subprocess.PIPE, text=True)
        with running([frozen]):
            assert frozen.stdout is not None and frozen.stdout.readline() == "up\n"
            frozen.send_signal(signal.SIGSTOP)
            pan = peer.subscription("/robot_7/pan_publisher", Float64_)
            assert hear(peer, pan, 3)
            begin = len(pan.received)
            peer.spin(4.0)
            times = [message.sample_info.source_timestamp / 1e9 for message in pan.messages[begin:]]
            assert len(times) > 110  # of 121
            assert max(after - before for before, after in itertools.pairwise(times)) < 0.3
            frozen.send_signal(signal.SIGCONT)


def test_domains_do_not_meet(jiwy: Path, net: Network, tmp_path: Path) -> None:
    with robot(net, jiwy, tmp_path), Peer(net.domain, "here") as here, Peer(net.domain + 1, "elsewhere") as elsewhere:
        meet(here)
        elsewhere.spin(1.0)
        assert elsewhere.graph.node_names() == ["/elsewhere"]


RANGE = (
    "<CycloneDDS><Domain><General><AllowMulticast>false</AllowMulticast></General>"
    "<Discovery><ParticipantIndex>auto</ParticipantIndex><MaxAutoParticipantIndex>32</MaxAutoParticipantIndex>"
    '<Peers><Peer address="localhost"/></Peers></Discovery></Domain></CycloneDDS>,'
)
"""The setting that rmw_cyclonedds uses for ROS_AUTOMATIC_DISCOVERY_RANGE=LOCALHOST."""


@pytest.mark.parametrize("variable", ["ROS_AUTOMATIC_DISCOVERY_RANGE=LOCALHOST", "ROS_LOCALHOST_ONLY=1"])
def test_it_is_found_on_this_computer_alone(jiwy: Path, net: Network, tmp_path: Path, variable: str) -> None:
    """A node of ROS 2 with the same variable discovers it, without multicast."""
    net.environment.update([variable.split("=")])
    os.environ["CYCLONEDDS_URI"] = RANGE + os.environ["CYCLONEDDS_URI"]
    with robot(net, jiwy, tmp_path), Peer(net.domain, "monitor") as peer:
        meet(peer)


def test_it_is_not_found_when_discovery_is_off(jiwy: Path, net: Network, tmp_path: Path) -> None:
    net.environment["ROS_AUTOMATIC_DISCOVERY_RANGE"] = "OFF"
    del net.environment["CYCLONEDDS_URI"]  # it contains the test's tag
    with robot(net, jiwy, tmp_path) as jiwy_robot, Peer(net.domain, "monitor") as peer:
        peer.spin(1.5)
        assert peer.graph.node_names() == ["/monitor"]
        assert jiwy_robot.end() == ""


@pytest.mark.parametrize(
    ("variable", "value", "message"),
    [
        (
            "ROS_DOMAIN_ID",
            "233",
            "error: ROS_DOMAIN_ID is '233'\nhint: a domain must be a whole number from 0 to 232\n",
        ),
        ("ROS_DOMAIN_ID", "-1", "error: ROS_DOMAIN_ID is '-1'\nhint: a domain must be a whole number from 0 to 232\n"),
        ("ROS_DOMAIN_ID", "a", "error: ROS_DOMAIN_ID is 'a'\nhint: a domain must be a whole number from 0 to 232\n"),
        (
            "ROS_AUTOMATIC_DISCOVERY_RANGE",
            "NEAR",
            "error: ROS_AUTOMATIC_DISCOVERY_RANGE is 'NEAR'\n"
            "hint: it must be SUBNET, LOCALHOST, OFF or SYSTEM_DEFAULT\n",
        ),
        (
            "ROS_STATIC_PEERS",
            'robot.local;"/><evil>',
            "error: ROS_STATIC_PEERS contains '\"/><evil>'\n"
            "hint: it must be a list of addresses with ';' between them\n",
        ),
    ],
)
def test_a_wrong_environment_is_said_once_and_the_loop_runs(
    jiwy: Path, net: Network, tmp_path: Path, variable: str, value: str, message: str
) -> None:
    net.environment[variable] = value
    trace = tmp_path / "trace.csv"
    command = [str(jiwy), "--realtime", "--quiet", "--duration", "1.5", "--trace", str(trace)]
    done = subprocess.run(command, env=net.environment, capture_output=True, text=True, check=False, timeout=60)
    assert (done.returncode, done.stderr) == (0, message)
    assert len(Robot(None, trace).signal("time")) > 1000  # type: ignore[arg-type]


def test_without_a_network_it_is_tried_again_and_the_loop_runs(jiwy: Path, tmp_path: Path) -> None:
    """CycloneDDS must use an interface that does not exist."""
    with network() as net:
        net.environment["CYCLONEDDS_URI"] = net.environment["CYCLONEDDS_URI"].replace("127.0.0.1", "192.0.2.77")
        trace = tmp_path / "trace.csv"
        command = [str(jiwy), "--realtime", "--quiet", "--duration", "2.5", "--trace", str(trace)]
        done = subprocess.run(command, env=net.environment, capture_output=True, text=True, check=False, timeout=60)
        assert done.returncode == 0
        assert done.stderr.count("error: cannot make a DDS participant: ") == 1
        assert "hint: the node tries again every second" in done.stderr
        assert len(Robot(None, trace).signal("time")) > 2000  # type: ignore[arg-type]
