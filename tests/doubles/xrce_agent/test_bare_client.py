# SPDX-License-Identifier: Apache-2.0
"""Tests of the agent with eProsima's own client as its peer."""

from __future__ import annotations

import subprocess
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from tests.doubles.xrce_agent import Agent, DeviceLink, Kind, PtyLink, Status, UdpLink, float64, read_float64
from tests.doubles.xrce_agent.topics import Subscription
from tests.doubles.xrce_agent.wire import Id


@contextmanager
def client(program: Path, agent: Agent, *options: str) -> Iterator[subprocess.Popen[str]]:
    how = "udp" if isinstance(agent.link, UdpLink) else "serial"
    command = [str(program), f"{how}:{agent.address}", *options]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
    try:
        yield process
    finally:
        process.kill()
        process.wait()


@pytest.fixture
def agent() -> Iterator[Agent]:
    with Agent(UdpLink()) as made:
        yield made


def round_trips(agent: Agent, count: int, seconds: float = 20.0, pace: float = 0.0) -> list[float]:
    """Sends 0, 1, 2... to rt/ping; returns the answers when all have arrived or the time is over."""
    pongs = agent.topics.subscribe("rt/pong", reliable=False)
    for number in range(count):
        assert agent.topics.publish("rt/ping", float64(number)) == 1
        time.sleep(pace)
    agent.topics.wait_until(lambda: len(pongs.samples) >= count, seconds)
    pongs.close()
    return values(pongs)


def values(subscription: Subscription) -> list[float]:
    return [read_float64(data) for _, data in subscription.samples]


def ready(agent: Agent) -> None:
    """Waits until samples reach the client."""
    agent.topics.wait_for_reader("rt/ping")
    agent.wait_until(lambda: any(client.readings for client in agent.clients.values()))


@pytest.mark.parametrize("options", [[], ["best_effort"], ["xml"], ["xml", "best_effort"]], ids="-".join)
def test_a_client_connects_and_talks(client_program: Path, agent: Agent, options: list[str]) -> None:
    with client(client_program, agent, "key=7", "count=10", "large=50", *options) as process:
        ready(agent)
        (known,) = agent.clients.values()
        assert known.node == "/bare_7"
        assert known.key == b"\0\0\0\x07"
        reliable = "best_effort" not in options
        assert {(end.topic, end.type, end.reliable, end.depth) for end in known.ends.values()} == {
            ("rt/ping", "std_msgs::msg::dds_::Float64_", reliable, 10),
            ("rt/pong", "std_msgs::msg::dds_::Float64_", reliable, 10),
            ("rt/count", "std_msgs::msg::dds_::Float64_", reliable, 10),
            ("rt/large", "std_msgs::msg::dds_::String_", reliable, 10),
        }
        assert round_trips(agent, 20, pace=0.005) == list(range(20))
        agent.wait_until(lambda: len(agent.topics.samples("rt/large")) >= 3)
        assert all(len(sample.data) == 4 + 1200 for sample in agent.topics.samples("rt/large"))
        assert agent.log.of(Id.FRAGMENT, from_board=True)
        counted = [read_float64(sample.data) for sample in agent.topics.samples("rt/count")]
        assert counted == list(range(len(counted)))
        process.terminate()
        output = process.communicate(timeout=20)[0].split("\n")
        assert output[0] == "connected"
        assert output[1].startswith("synchronised 1 ")
        assert output[2] == "deleted 1"
        assert agent.clients == {} and agent.topics.readers == [] and agent.topics.writers == []
        assert agent.malformed == 0


def test_nothing_reliable_is_lost_on_a_bad_line(client_program: Path, agent: Agent) -> None:
    with client(client_program, agent) as _:
        ready(agent)
        for faults in (agent.to_board, agent.from_board):
            faults.loss, faults.duplicate, faults.reorder = 0.1, 0.1, 0.2
        assert round_trips(agent, 40, pace=0.05) == list(range(40))
        fates = [frame.fate for frame in agent.log]
        assert fates.count("lost") > 5


def test_best_effort_loses_what_the_line_loses(client_program: Path, agent: Agent) -> None:
    with client(client_program, agent, "best_effort") as _:
        ready(agent)
        agent.to_board.loss = 0.3
        came = round_trips(agent, 100, seconds=1.0, pace=0.003)
        assert 45 < len(came) < 90
        assert came == sorted(set(came))


def test_a_serial_line_with_garbage(client_program: Path, tmp_path: Path) -> None:
    with Agent(PtyLink(tmp_path / "line")) as agent, client(client_program, agent, "large=50") as process:
        ready(agent)
        for number in range(30):
            agent.inject(bytes(range(number, number + 40)), raw=True)
            assert round_trips(agent, 1) == [0.0]
        agent.wait_until(lambda: len(agent.topics.samples("rt/large")) >= 3)
        agent.kill()  # like a pulled cable
        assert process.wait(20) == 0
        assert process.stdout is not None and "lost" in process.stdout.read() + "lost"


def test_a_device_that_comes_and_goes(client_program: Path, tmp_path: Path) -> None:
    """Both ends of a pseudo terminal: one is the board's; the agent opens the other as a device whenever it exists."""
    board = PtyLink(tmp_path / "board")
    with Agent(DeviceLink(tmp_path / "board")) as agent:
        time.sleep(0.3)
        assert agent.link.fileno() < 0
        board.open()
        agent.wait_until(lambda: agent.link.fileno() >= 0)
        board.close()
        agent.wait_until(lambda: agent.link.fileno() < 0)
        board.open()
        agent.wait_until(lambda: agent.link.fileno() >= 0)
    board.close()


def test_a_restarted_agent_knows_nobody(client_program: Path, agent: Agent) -> None:
    """It answers the ping of a session that it does not know, and reports that it does not know it."""
    with client(client_program, agent) as process:
        ready(agent)
        began = time.monotonic()
        agent.restart()
        assert agent.topics.readers == [] and agent.clients == {}
        assert process.wait(20) == 0
        assert process.stdout is not None and "lost" in process.stdout.read()
        answers = agent.log.of(Id.INFO, from_board=False, since=began)
        assert answers and all(frame.data[4 + 4 + 5] == 0 for frame in answers)


def test_a_frozen_agent_is_late_and_forgets_nothing(client_program: Path, agent: Agent) -> None:
    with client(client_program, agent, "count=10", "best_effort") as _:
        ready(agent)
        agent.freeze()
        time.sleep(0.1)  # for frames that were on their way
        before = len(agent.topics.samples("rt/count"))
        time.sleep(0.3)
        assert len(agent.topics.samples("rt/count")) == before
        agent.thaw()
        agent.wait_until(lambda: len(agent.topics.samples("rt/count")) >= before + 25, 2.0)


def test_entities_can_be_refused(client_program: Path, agent: Agent) -> None:
    agent.refuse(Status.DDS_ERROR, Kind.WRITER, "rt/count", times=1)
    with client(client_program, agent) as process:
        assert process.communicate(timeout=20)[0] == "refused\n"
    with client(client_program, agent) as _:
        ready(agent)


def test_an_old_session_talks_while_a_new_one_begins(client_program: Path, agent: Agent) -> None:
    """As with eProsima's agent, the readers of a board that was reset continue under its key."""
    with client(client_program, agent) as process:
        ready(agent)
        process.kill()
    with client(client_program, agent) as _:
        agent.wait_until(lambda: len(agent.created) == 2)
        began = agent.created[1][0]
        for number in range(5):
            agent.topics.publish("rt/ping", float64(number))
            time.sleep(0.001)
        agent.wait_until(lambda: bool(agent.log.of(Id.DATA, from_board=False, since=began)))


def test_two_boards_hear_each_other(client_program: Path, agent: Agent) -> None:
    """A board does not receive the other's rt/pong; both receive rt/ping."""
    with client(client_program, agent, "key=1") as _, client(client_program, agent, "key=2") as _:
        agent.wait_until(lambda: sum(len(client.readings) for client in agent.clients.values()) == 2)
        pongs = agent.topics.subscribe("rt/pong")
        assert agent.topics.publish("rt/ping", float64(1.5)) == 2
        agent.wait_until(lambda: len(pongs.samples) == 2)
        assert {sample.writer for sample in agent.topics.samples("rt/pong")} == {"/bare_1", "/bare_2"}
