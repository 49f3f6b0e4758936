# SPDX-License-Identifier: Apache-2.0
"""A board connects, detects a lost agent and connects again, for any fault of agent, line and board."""

from __future__ import annotations

import random
import signal
import time
from collections.abc import Hashable
from pathlib import Path

import pytest

from tests.doubles.xrce_agent import Agent, Kind, Link, PtyLink, Status, UdpLink
from tests.doubles.xrce_agent.wire import Header, Id, Submessage
from tests.waiting import until

from .board import Board
from .checks import check_alive, check_board_before_agent, check_end_of_session, check_topics


def test_the_agent_is_there_first(robot: Path, agent: Agent) -> None:
    with Board(robot, agent) as board:
        assert board.running() < 5000
        (client,) = agent.clients.values()
        assert client.node == "/lab/robot_1"
        check_topics(agent)
        check_alive(board, 0.5)
        check_end_of_session(board)


def test_the_board_is_there_first(robot: Path, agent: Agent) -> None:
    agent.kill()
    with Board(robot, agent) as board:
        check_board_before_agent(board, longest=3.0)
        assert board.stop() == ""


@pytest.mark.parametrize("pause", [0.0, 0.3, 2.0])
def test_the_agent_is_restarted(robot: Path, agent: Agent, pause: float) -> None:
    """Even a restart too fast for a timeout is detected.  The control loop is undisturbed."""
    with Board(robot, agent) as board:
        board.running()
        check_alive(board, 0.5)
        began, cycles = board.began(), board.cycles()
        agent.restart(pause)
        assert board.running() - cycles < 1000 * (3.0 + pause)
        assert board.next("got_reliable") == 0.5  # the board has kept its setpoint
        check_alive(board, 0.75)
        assert abs(board.began() - began) < 0.06, "a cycle is lost only if the computer is late"
        diagnostics = board.diagnostics()
        assert diagnostics.values["reconnects"] == "1"
        assert (diagnostics.state, diagnostics.values["faults"]) == ("enabled", "0")
        assert board.stop() == ""


def test_the_first_samples_after_a_reconnection_are_new(robot: Path, agent: Agent) -> None:
    """After a reconnection, no old value is sent: neither values of the board nor setpoints."""
    with Board(robot, agent) as board:
        board.running()
        for _ in range(3):
            before = board.cycles()
            agent.kill()
            board.lose()
            agent.topics.publish("rt/lab/reliable", bytes(8))  # no agent is there that could keep it
            since = agent.topics.count
            agent.start()
            board.running()
            board.next("cycles")
            for topic in ("cycles", "cycles_too"):
                assert board.values(topic, since)[0] > before + 1000, "the board was alone for longer than a second"
        assert board.next("got_reliable") == 0.25
        assert board.stop() == ""


def test_a_frozen_agent_is_given_up_and_found_again(robot: Path, agent: Agent) -> None:
    with Board(robot, agent) as board:
        board.running()
        check_alive(board, 0.5)
        agent.freeze()
        board.lose()
        sessions = len(agent.created)
        agent.thaw()
        agent.wait_until(lambda: len(agent.created) > sessions)
        check_alive(board, 0.75)
        assert board.statistic("reconnects") == 1
        assert board.stop() == ""


def test_a_cable_is_pulled(robot: Path, tmp_path: Path) -> None:
    with Agent(PtyLink(tmp_path / "line")) as agent, Board(robot, agent) as board:
        for turn in range(4):
            board.running()
            check_alive(board, 0.5 + turn / 8)
            agent.kill()
            assert not (tmp_path / "line").exists()
            if turn % 2:
                board.lose()
            agent.start()
        agent.wait_until(lambda: board.statistic("reconnects") == 4)
        assert board.stop() == ""


def test_a_line_without_an_agent_on_it(robot: Path, tmp_path: Path) -> None:
    """The terminal exists and stays open, but no agent answers."""
    with Agent(PtyLink(tmp_path / "line")) as agent, Board(robot, agent) as board:
        board.running()
        agent.freeze()
        board.lose()
        agent.thaw()
        agent.wait_until(lambda: len(agent.created) >= 2)
        check_alive(board, 0.5)
        assert board.stop() == ""


@pytest.mark.parametrize("way", ["killed", "stopped"])
def test_the_board_is_restarted(robot: Path, agent: Agent, way: str) -> None:
    """Its old readers are flooded: their samples arrive while the new readers are made."""
    with Board(robot, agent) as board:
        board.running()
        board.kill() if way == "killed" else board.stop()
    for turn in range(5):
        with Board(robot, agent) as board:
            since = agent.topics.count

            def flooded(board: Board = board, since: int = since) -> bool:
                board.set("reliable", 0.25)
                board.set("quick", 0.25)
                return len(board.values("cycles_too", since)) > 5

            until(flooded, agent.tail, pause=0.001)
            check_alive(board, 0.5 + turn / 16)
            if way == "killed":
                board.kill()
            else:
                assert board.stop() == ""


def test_loss_both_ways(robot: Path, agent: Agent) -> None:
    """A tenth of all frames is lost: the board stays connected; reliable messages arrive in order and only once."""
    with Board(robot, agent) as board:
        board.running()
        heard = agent.topics.subscribe("rt/lab/cycles", reliable=True)
        agent.to_board.loss = agent.from_board.loss = 0.1
        since = agent.topics.count
        agent.log.clear()
        for number in range(40):
            value = 1.0 + number / 64
            board.set("reliable", value)
            board.wait_for("got_reliable", value, 5.0)
        assert sum(frame.fate == "lost" for frame in agent.log) > 10
        assert len(agent.created) == 1
        cycles = board.values("cycles", since)
        assert cycles == sorted(set(cycles))
        assert len(heard.samples) > 0.5 * (cycles[-1] - cycles[0]) / 20
        assert board.stop() == ""


def test_connecting_over_a_bad_line(robot: Path, agent: Agent) -> None:
    agent.to_board.loss = agent.from_board.loss = 0.2
    agent.to_board.duplicate = agent.from_board.duplicate = 0.2
    agent.to_board.reorder = agent.from_board.reorder = 0.2
    with Board(robot, agent) as board:
        board.running()
        check_alive(board, 0.5)
        assert board.stop() == ""


def test_duplicates_and_another_order(robot: Path, agent: Agent) -> None:
    with Board(robot, agent) as board:
        board.running()
        for faults in (agent.to_board, agent.from_board):
            faults.duplicate, faults.reorder, faults.delay = 0.3, 0.3, (0.0, 0.005)
        since = agent.topics.count
        for number in range(60):
            board.set("reliable", 1.0 + number / 64)
            board.publishes(1)
        board.wait_for("got_reliable", 1.0 + 59 / 64)  # the newest value, not a late one
        for topic in ("got_reliable", "cycles", "cycles_too"):
            values = board.values(topic, since)
            assert len(values) > 20
            assert values == sorted(values), topic
        assert len(agent.created) == 1
        agent.to_board.clear()
        agent.from_board.clear()
        assert board.stop() == ""


@pytest.mark.parametrize(("delay", "sessions"), [(0.06, 1), (0.15, 5)])
def test_a_slow_line(robot: Path, agent: Agent, delay: float, sessions: int) -> None:
    """``delay`` is in seconds per direction.  If an answer takes longer than a board waits, the board asks again."""
    agent.to_board.delay = agent.from_board.delay = (delay, delay)
    with Board(robot, agent) as board:
        board.running()
        check_alive(board, 0.5)
        since = agent.topics.count
        board.passes(1500)
        assert len(board.values("cycles_too", since)) > 60
        assert len(agent.created) <= sessions
        assert board.stop() == ""


class SlowAgent(Agent):
    """Needs time to make a session, and handles nothing else meanwhile, like an agent that deletes the old entities."""

    seconds = 1.2

    def _create_client(self, peer: Hashable, header: Header, part: Submessage) -> None:
        time.sleep(self.seconds)  # the agent is slow
        super()._create_client(peer, header, part)


def test_an_agent_that_is_slow_to_make_a_session(robot: Path) -> None:
    """Each further request would end the session that is being made: a board must learn to send fewer requests."""
    with SlowAgent(UdpLink()) as agent, Board(robot, agent) as board:
        board.running()
        check_alive(board, 0.5)
        sessions = len(agent.created)
        assert sessions <= 5
        board.passes(1000)
        assert len(agent.created) == sessions
        assert board.stop() == ""


@pytest.mark.parametrize("line", ["udp", "serial"])
def test_garbage_and_damaged_frames(robot: Path, tmp_path: Path, line: str) -> None:
    """Sanitizers would detect errors; after the garbage, everything works as before."""
    chance = random.Random(7)
    link: Link = PtyLink(tmp_path / "line") if line == "serial" else UdpLink()
    with Agent(link) as agent, Board(robot, agent) as board:
        board.running()
        agent.to_board.truncate = agent.from_board.truncate = 0.1
        if line == "serial":  # for datagrams, the system's checksums would detect it
            agent.to_board.corrupt = agent.from_board.corrupt = 0.1
        end = board.cycles() + 3000

        def spoilt() -> bool:
            size = chance.randrange(1, 600)
            header = bytes([0x81, chance.choice((0, 1, 0x80))]) + chance.randrange(65536).to_bytes(2, "little")
            agent.inject((header if chance.random() < 0.7 else b"") + chance.randbytes(size), chance.random() < 0.3)
            board.set("reliable", chance.random())
            board.topics.publish("rt/lab/quick", chance.randbytes(chance.randrange(40)), False)
            return board.cycles() > end

        until(spoilt, agent.tail, pause=0.003)
        agent.to_board.clear()
        agent.from_board.clear()
        board.running()
        check_alive(board, 0.5)
        assert int(board.diagnostics().values["malformed"]) > 10
        assert board.stop() == ""


def test_a_dead_board_leaves_the_graph(robot: Path, agent: Agent) -> None:
    """An agent with hard liveliness removes its entities; a board that was only suspended connects again."""
    with Board(robot, agent) as board:
        board.running()
        (client,) = agent.clients.values()
        assert client.dead_after == 3.0
        board.process.send_signal(signal.SIGSTOP)
        agent.wait_until(lambda: not agent.clients, 8.0)
        board.process.send_signal(signal.SIGCONT)
        board.running()
        board.kill()
        agent.wait_until(lambda: not agent.clients, 8.0)


def test_two_boards(robot: Path, agent: Agent) -> None:
    """One image for both: names and keys differ by the serial number; a fault of one does not affect the other."""
    with Board(robot, agent, serial="A") as one, Board(robot, agent, serial="B") as other:
        one.running()
        other.running()
        assert {client.node for client in agent.clients.values()} == {"/lab/robot_A", "/lab/robot_B"}
        assert len({client.key for client in agent.clients.values()}) == 2
        assert one.set("reliable", 0.5) == 2
        one.wait_for("got_reliable", 0.5)
        other.wait_for("got_reliable", 0.5)
        one.kill()
        since = agent.topics.count
        other.passes(500)
        assert len(other.values("cycles", since)) > 15
        assert other.stop() == ""


@pytest.mark.parametrize("kind", [Kind.PARTICIPANT, Kind.TOPIC, Kind.WRITER, Kind.READER])
def test_what_is_refused_is_asked_for_again(robot: Path, agent: Agent, kind: Kind) -> None:
    agent.refuse(Status.DDS_ERROR, kind, times=1)
    with Board(robot, agent) as board:
        assert board.running() < 10_000
        check_alive(board, 0.5)
        assert board.statistic("reconnects") == 0
        assert board.stop() == ""


def test_an_agent_that_answers_pings_only(robot: Path, agent: Agent) -> None:
    """Like half a restart: the agent drops all requests."""
    agent.mute = {Id.CREATE}
    with Board(robot, agent) as board:
        agent.wait_until(lambda: len(agent.log.of(Id.CREATE, from_board=True)) > 3)
        agent.mute = set()
        board.running()
        check_alive(board, 0.5)
        assert board.stop() == ""
