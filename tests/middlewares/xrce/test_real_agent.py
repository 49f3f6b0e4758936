# SPDX-License-Identifier: Apache-2.0
"""The board, eProsima's agent with Fast DDS, and a peer with CycloneDDS that looks like a ROS 2 node."""

from __future__ import annotations

import itertools
import signal
import subprocess
import time
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path

import pytest

from tests.doubles.toolchain import Missing
from tests.doubles.xrce_agent.ptys import Cable
from tests.doubles.xrce_agent.real_agent import RealAgent, free_domain, on_loopback, program

pytest.importorskip("tests.doubles.ros2_peer.packages", exc_type=ImportError)

from cyclonedds.builtin import BuiltinDataReader, BuiltinTopicDcpsParticipant
from cyclonedds.core import Policy

from tests.doubles.ros2_peer.messages import Bool_, DiagnosticArray_, Float64_, numbers
from tests.doubles.ros2_peer.peer import Peer, Publisher, Subscription


@pytest.fixture(autouse=True)
def _agent_program() -> None:
    try:
        program()
    except Missing as missing:
        pytest.skip(str(missing))


def lost_and_connected(agent: str | Path) -> str:
    """The lines that a board prints when its agent is restarted, also with --quiet."""
    return f"robot: lost the agent at {agent}\nrobot: connected to the agent at {agent}\n"


@contextmanager
def board(robot: Path, *way: str) -> Iterator[subprocess.Popen[str]]:
    command = [str(robot), "--realtime", "--quiet", *way]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    try:
        yield process
    finally:
        process.kill()
        process.communicate()


def stop(process: subprocess.Popen[str]) -> str:
    """Ends the process; returns its output, which is empty unless a sanitizer reports an error."""
    process.terminate()
    return process.communicate(timeout=20)[0]


def check_alive(peer: Peer, commands: Publisher, answers: Subscription, value: float) -> None:
    """A setpoint reaches the board, and the answer comes back."""
    seen = len(answers.messages)

    def done() -> bool:
        commands.publish(Float64_(value))
        return value in numbers(answers.messages[seen:])

    assert peer.spin_until(done)


def test_a_peer_sees_a_node_with_its_topics(robot: Path, tmp_path: Path) -> None:
    with on_loopback(), RealAgent.udp(tmp_path) as agent, Peer(agent.domain, "peer") as peer:
        reliable, answers = peer.publisher("/lab/reliable", Float64_), peer.subscription("/lab/got_reliable", Float64_)
        quick, quick_answers = (
            peer.publisher("/lab/quick", Float64_, reliable=False),
            peer.subscription("/lab/got_quick", Float64_, reliable=False),
        )
        hopeless = peer.subscription("/lab/got_quick", Float64_, reliable=True)
        diagnostics = peer.subscription("/diagnostics", DiagnosticArray_)
        with board(robot, "--serial", "9", "--agent", agent.address) as process:
            check_alive(peer, reliable, answers, 0.5)
            check_alive(peer, quick, quick_answers, 0.75)
            assert hopeless.messages == [] and hopeless.refused_for == "RELIABILITY"
            assert peer.spin_until(lambda: len(diagnostics.messages) > 2)
            status = diagnostics.messages[-1].status[0]
            assert status.name == "lab/robot_9" and status.message.split(";")[0] == "enabled"
            assert status.level == (0 if status.message == "enabled" else 1)  # a busy computer has overruns
            stamp = diagnostics.messages[-1].header.stamp
            # the clock of the agent, which stamps follow
            assert abs(stamp.sec + stamp.nanosec / 1e9 - time.time()) < 1.0
            theirs = {(end.topic, end.type, end.reliable) for end in peer.graph.publications()}
            assert theirs >= {
                ("/lab/got_reliable", "std_msgs/msg/Float64", True),
                ("/lab/got_quick", "std_msgs/msg/Float64", False),
                ("/diagnostics", "diagnostic_msgs/msg/DiagnosticArray", True),
            }
            participants = BuiltinDataReader(peer._participant, BuiltinTopicDcpsParticipant)
            names = {s.qos[Policy.EntityName].name for s in participants.read(20) if Policy.EntityName in s.qos}
            assert "lab/robot_9" in names
            enable = peer.publisher("/lab/robot_9/enable", Bool_)
            assert peer.spin_until(lambda: enable.matched == 1)
            enable.publish(Bool_(False))
            assert peer.spin_until(lambda: diagnostics.messages[-1].status[0].level == 1)
            assert stop(process) == ""
        assert peer.spin_until(lambda: reliable.matched == 0)  # the board has closed its session


def test_the_period_is_kept(robot: Path, tmp_path: Path) -> None:
    with on_loopback(), RealAgent.udp(tmp_path) as agent, Peer(agent.domain, "peer") as peer:
        cycles = peer.subscription("/lab/cycles", Float64_, depth=200)
        with board(robot, "--agent", agent.address) as process:
            assert peer.spin_until(lambda: len(cycles.messages) > 5)
            seen = len(cycles.messages)
            peer.spin(2.0)
            values = numbers(cycles.messages[seen:])
            assert abs(len(values) - 100) <= 6
            steps = sorted(after - before for before, after in itertools.pairwise(values))
            assert steps[len(steps) // 2] == 20
            assert stop(process) == ""


def test_it_is_killed_and_started_again(robot: Path, tmp_path: Path) -> None:
    with on_loopback(), RealAgent.udp(tmp_path) as agent, Peer(agent.domain, "peer") as peer:
        commands, answers = peer.publisher("/lab/reliable", Float64_), peer.subscription("/lab/got_reliable", Float64_)
        diagnostics = peer.subscription("/diagnostics", DiagnosticArray_)
        with board(robot, "--agent", agent.address) as process:
            check_alive(peer, commands, answers, 0.5)
            for turn in range(5):
                agent.restart()
                check_alive(peer, commands, answers, 1.0 + turn / 8)
            values = {}

            def counted() -> bool:
                if diagnostics.messages:
                    values.update({pair.key: pair.value for pair in diagnostics.messages[-1].status[0].values})
                return values.get("reconnects") == "5"

            assert peer.spin_until(counted)
            assert values["faults"] == "0"
            assert stop(process) == 5 * lost_and_connected(agent.address)


def test_it_is_stopped_for_a_while(robot: Path, tmp_path: Path) -> None:
    with on_loopback(), RealAgent.udp(tmp_path) as agent, Peer(agent.domain, "peer") as peer:
        commands, answers = peer.publisher("/lab/reliable", Float64_), peer.subscription("/lab/got_reliable", Float64_)
        with board(robot, "--agent", agent.address) as process:
            check_alive(peer, commands, answers, 0.5)
            agent.signal(signal.SIGSTOP)
            peer.spin(2.5)
            agent.signal(signal.SIGCONT)
            check_alive(peer, commands, answers, 0.75)
            assert stop(process) == ""


@pytest.mark.parametrize("way", ["killed", "stopped"])
def test_the_board_is_restarted(robot: Path, tmp_path: Path, way: str) -> None:
    """Setpoints arrive all the time."""
    with on_loopback(), RealAgent.udp(tmp_path) as agent, Peer(agent.domain, "peer") as peer:
        commands, answers = peer.publisher("/lab/reliable", Float64_), peer.subscription("/lab/got_reliable", Float64_)
        for turn in range(5):
            with board(robot, "--agent", agent.address) as process:
                check_alive(peer, commands, answers, 1.0 + turn / 8)
                if way == "killed":
                    process.kill()
                else:
                    assert stop(process) == ""


@pytest.mark.parametrize("way", [signal.SIGTERM, signal.SIGKILL])
@pytest.mark.parametrize(("count", "leave"), [(3, 1), (6, 1), (6, 3)])
def test_boards_leave(robot: Path, tmp_path: Path, count: int, leave: int, way: signal.Signals) -> None:
    """The agent deletes their readers under the lock of all clients.  The others wait, and none loses its session."""
    with on_loopback(), RealAgent.udp(tmp_path) as agent, Peer(agent.domain, "peer") as peer, ExitStack() as boards:
        diagnostics = peer.subscription("/diagnostics", DiagnosticArray_, depth=10 * count)

        def heard(first: int) -> dict[str, list[tuple[float, str]]]:
            """For each board, the stamps of its messages from the first one on and its number of reconnections."""
            found: dict[str, list[tuple[float, str]]] = {}
            for message in diagnostics.messages[first:]:
                values = {pair.key: pair.value for pair in message.status[0].values}
                stamp = message.header.stamp.sec + message.header.stamp.nanosec / 1e9
                found.setdefault(message.status[0].name, []).append((stamp, values["reconnects"]))
            return found

        processes = [
            boards.enter_context(board(robot, "--serial", str(number), "--agent", agent.address))
            for number in range(count)
        ]
        assert peer.spin_until(lambda: len(heard(0)) == count, 40.0)
        peer.spin(2.0)
        first = len(diagnostics.messages) - count
        for process in processes[:leave]:
            process.send_signal(way)
        peer.spin(9.0)
        messages = {name: each for name, each in heard(first).items() if int(name.removeprefix("lab/robot_")) >= leave}
        assert len(messages) == count - leave
        stamps = [[stamp for stamp, _ in each] for each in messages.values()]
        assert min(each[-1] - each[0] for each in stamps) > 8.0, "they have not stopped"
        silent = max(after - before for each in stamps for before, after in itertools.pairwise(each))
        print(f"{leave} of {count} boards, {way.name}: the others were silent for {silent:.2f} s")
        assert {reconnects for each in messages.values() for _, reconnects in each} == {"0"}
        assert silent < 4.0


def test_on_a_serial_line(robot: Path, tmp_path: Path) -> None:
    with on_loopback(), Cable() as cable:
        agent = RealAgent(["serial", "-b", "115200", "-D", cable.ends[0]], free_domain(), tmp_path)
        with agent, Peer(agent.domain, "peer") as peer:
            commands = peer.publisher("/lab/reliable", Float64_)
            answers = peer.subscription("/lab/got_reliable", Float64_)
            with board(robot, "--serial-device", cable.ends[1]) as process:
                for turn in range(3):
                    check_alive(peer, commands, answers, 1.0 + turn / 8)
                    agent.restart()
                check_alive(peer, commands, answers, 0.5)
                assert stop(process) == 3 * lost_and_connected(cable.ends[1])
