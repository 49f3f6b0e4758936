# SPDX-License-Identifier: Apache-2.0
"""Services of a board: requests, replies, waiting requests, and agents that fail in between."""

from __future__ import annotations

import struct
from pathlib import Path

import pytest

from tests.doubles.xrce_agent import Agent, Kind
from tests.doubles.xrce_agent.wire import CdrReader

from .board import Board

ON, OFF, EMPTY = b"\1", b"\0", b"\0"
ENABLE, RESET = "/lab/robot_1/enable", "/lab/robot_1/reset"
SERVICE_STREAM = 0x81


def result(reply: bytes) -> tuple[bool, str]:
    """The content of a response of SetBool or Trigger."""
    reader = CdrReader(reply)
    content = (reader.flag(), reader.string())
    assert reader.position == len(reply)
    return content


def serving(board: Board) -> Board:
    board.running()
    board.topics.wait_for_service(RESET)
    return board


@pytest.fixture
def board(board: Board) -> Board:
    return serving(board)


def test_enable_and_reset(robot: Path, agent: Agent) -> None:
    with Board(robot, agent) as board:
        serving(board)
        assert result(agent.topics.call(ENABLE, OFF)) == (True, "disabled")
        agent.wait_until(lambda: board.diagnostics().message == "disabled")
        assert result(agent.topics.call(ENABLE, ON)) == (True, "enabled")
        assert result(agent.topics.call(RESET, EMPTY)) == (True, "enabled")
        assert board.stop() == ""
        assert agent.malformed == 0


def test_names_and_types_of_repliers(board: Board, agent: Agent) -> None:
    (client,) = agent.clients.values()
    repliers = {d.name: (d.type, *d.replies) for d in client.objects.values() if d.kind == Kind.REPLIER}
    assert repliers[f"rq{ENABLE}Request"] == (
        "std_srvs::srv::dds_::SetBool_Request_",
        f"rr{ENABLE}Reply",
        "std_srvs::srv::dds_::SetBool_Response_",
    )
    assert repliers[f"rq{RESET}Request"] == (
        "std_srvs::srv::dds_::Trigger_Request_",
        f"rr{RESET}Reply",
        "std_srvs::srv::dds_::Trigger_Response_",
    )


def test_many_requests_at_once_are_all_answered(board: Board, agent: Agent) -> None:
    """More than the windows of the stream, and more than one at a time."""
    asked = []
    for number in range(40):
        asked.append(agent.topics.ask(ENABLE, ON if number % 2 else OFF))
        if number % 10 == 9:  # the agent keeps one request that it cannot send
            agent.wait_until(lambda: all(agent.topics.answers(ENABLE, each) for each in asked))
    answers = [[result(each) for each in agent.topics.answers(ENABLE, number)] for number in asked]
    assert answers[::2] == [[(True, "disabled")]] * 20
    for answer in answers[1::2]:  # a request to disable overtakes one to enable that waits
        assert answer in ([(True, "enabled")], [(False, "refused, stopped by service")])
    assert answers[-1] == [(True, "enabled")]


def test_a_bad_line_loses_no_request(board: Board, agent: Agent) -> None:
    for faults in (agent.to_board, agent.from_board):
        faults.loss, faults.duplicate, faults.reorder = 0.2, 0.1, 0.1
    for number in range(20):
        state = number % 2 == 1
        assert result(agent.topics.call(ENABLE, bytes([state]))) == (True, "enabled" if state else "disabled")
    for faults in (agent.to_board, agent.from_board):
        faults.clear()


def test_malformed_requests_are_counted_and_others_answered(board: Board, agent: Agent) -> None:
    """Too short, not a Boolean, and much larger than the board's memory: all are dropped."""
    wrong = [b"", b"\2", bytes(100), bytes(5000), bytes(40_000)]
    for data in wrong:
        agent.topics.ask(ENABLE, data)
        agent.topics.call(RESET, EMPTY)
    agent.wait_until(lambda: board.statistic("malformed") == len(wrong))
    assert result(agent.topics.call(ENABLE, ON)) == (True, "enabled")
    assert board.statistic("reconnects") == 0


def test_requests_do_not_stop_setpoints(board: Board, agent: Agent) -> None:
    """The answers to requests are lost, so requests wait.  Reliable setpoints and publications go on."""
    agent.mute_streams.add(SERVICE_STREAM)
    asked = [agent.topics.ask(ENABLE, ON) for _ in range(3)]
    for number in range(5):
        board.set("reliable", 1.0 + number / 32)
        assert board.wait_for("got_reliable", 1.0 + number / 32) < 500
    agent.mute_streams.clear()
    agent.wait_until(lambda: all(agent.topics.answers(ENABLE, each) for each in asked))
    assert board.statistic("reconnects") == 0


def test_a_request_to_disable_does_not_wait_for_replies(board: Board, agent: Agent) -> None:
    """The answers to requests are lost, so requests wait: the one to disable acts, and the one before it never does."""
    assert result(agent.topics.call(ENABLE, ON)) == (True, "enabled")
    agent.mute_streams.add(SERVICE_STREAM)
    agent.topics.ask(RESET, EMPTY)
    asked = [agent.topics.ask(ENABLE, state) for state in (ON, OFF)]
    agent.wait_until(lambda: board.diagnostics().message == "disabled")
    agent.mute_streams.clear()
    agent.wait_until(lambda: all(agent.topics.answers(ENABLE, each) for each in asked))
    answers = [result(answer) for each in asked for answer in agent.topics.answers(ENABLE, each)]
    assert answers == [(False, "refused, stopped by service"), (True, "disabled")]
    assert result(agent.topics.call(ENABLE, ON)) == (True, "enabled")


def test_a_request_to_enable_that_waits_does_not_act_after_a_stop(robot: Path, agent: Agent) -> None:
    """The stop comes by the topic, while the request waits for the reply to another one."""
    with Board(robot, agent) as board:
        serving(board)
        assert result(agent.topics.call(ENABLE, ON)) == (True, "enabled")
        agent.mute_streams.add(SERVICE_STREAM)
        agent.topics.ask(RESET, EMPTY)
        asked = agent.topics.ask(ENABLE, ON)
        board.publishes(10)
        agent.topics.publish(f"rt{ENABLE}", OFF)
        agent.wait_until(lambda: board.diagnostics().message == "disabled")
        board.publishes(10)
        agent.mute_streams.clear()
        agent.wait_until(lambda: bool(agent.topics.answers(ENABLE, asked)))
        assert [result(each) for each in agent.topics.answers(ENABLE, asked)] == [(False, "refused, stopped by topic")]
        assert board.diagnostics().message == "disabled"
        assert result(agent.topics.call(ENABLE, ON)) == (True, "enabled")
        assert board.stop() == ""


def test_an_agent_is_killed_with_requests_in_work(robot: Path, agent: Agent) -> None:
    with Board(robot, agent) as board:
        for _ in range(3):
            serving(board)
            agent.mute_streams.add(SERVICE_STREAM)
            lost = agent.topics.ask(ENABLE, OFF)
            board.publishes(3)
            agent.kill()
            agent.mute_streams.clear()
            agent.topics.clear()
            agent.start()
            serving(board)
            assert agent.topics.answers(ENABLE, lost) == []
            assert result(agent.topics.call(ENABLE, ON)) == (True, "enabled")
        assert board.stop() == ""
        assert agent.malformed == 0


def test_requests_that_are_not_for_a_service(board: Board, agent: Agent) -> None:
    """Frames of the services' stream with other submessages, other objects or wrong lengths do no harm."""
    assert result(agent.topics.call(ENABLE, ON)) == (True, "enabled")
    head = b"\0\1"
    for body in (
        b"",
        b"\x09\x01\xff\xff" + bytes(40),
        b"\x09\x01\x1d\x00" + head + b"\x00\x96" + bytes(25),  # a replier that does not exist
        b"\x09\x01\x1d\x00" + head + b"\x00\x16" + bytes(25),  # a reader
        b"\x09\x00\x00\x1d" + head + b"\x00\x18" + bytes(25),  # big-endian
        b"\x0d\x01\x04\x00" + bytes(4),  # a fragment without an end
        b"\x0d\x03\x00\x00",  # an end without a beginning
        b"\x05\x01\x06\x00" + bytes(6),
    ):
        agent.say(SERVICE_STREAM, body)
    assert result(agent.topics.call(ENABLE, OFF)) == (True, "disabled")
    for number in (0, 0x7FFF, 0x8000, 0xFFFF):
        agent.inject(struct.pack("<BBH", 0x81, SERVICE_STREAM, number) + b"\x09\x01\x1d\x00" + bytes(29))
        for missing in (0, 0xFFFF):
            numbers = struct.pack("<HH", number, missing) + bytes([SERVICE_STREAM])
            for kind in (b"\x0a", b"\x0b"):
                agent.inject(b"\x81\0\0\0" + kind + b"\x01\x05\0" + numbers)
    assert result(agent.topics.call(ENABLE, ON)) == (True, "enabled")
