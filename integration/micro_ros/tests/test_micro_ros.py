# SPDX-License-Identifier: Apache-2.0
"""The middleware ``micro_ros``: topics in both directions, QoS, an agent that restarts, a serial line."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.doubles.xrce_agent import Agent, PtyLink
from tests.middlewares.xrce.board import Board
from tests.middlewares.xrce.checks import (
    check_alive,
    check_board_before_agent,
    check_end_of_session,
    check_newest_setpoints,
    check_period,
    check_stamps,
    check_topics,
    check_wrong_setpoints,
)


def test_node_and_topics_are_those_of_xrce(robot: Path, agent: Agent) -> None:
    with Board(robot, agent) as board:
        board.running()
        check_topics(agent)
        check_alive(board, 0.5)
        check_end_of_session(board)


def test_a_period_is_20_ms_and_of_one_control_cycle(robot: Path, agent: Agent) -> None:
    with Board(robot, agent) as board:
        board.running()
        check_period(board, error=0.5)
        assert board.stop() == ""


def test_the_newest_setpoint_counts(robot: Path, agent: Agent) -> None:
    with Board(robot, agent) as board:
        board.running()
        check_newest_setpoints(board)
        assert board.stop() == ""


def test_what_is_no_number_is_dropped_and_counted(robot: Path, agent: Agent) -> None:
    with Board(robot, agent) as board:
        board.running()
        check_wrong_setpoints(board, [b"\0" * 7, b"\0" * 600])
        assert board.stop() == ""


def test_the_enable_topic(robot: Path, agent: Agent) -> None:
    with Board(robot, agent) as board:
        board.running()
        assert board.diagnostics().state == "enabled"
        board.enable(False)
        agent.wait_until(lambda: board.diagnostics().state == "disabled")
        board.enable(True)
        agent.wait_until(lambda: board.diagnostics().state == "enabled")
        assert board.stop() == ""


def test_stamps_are_of_the_agents_clock(robot: Path, agent: Agent) -> None:
    agent.clock_offset = 1000.0
    with Board(robot, agent) as board:
        board.running()
        check_stamps(board, 1000.0, earliest=-0.2, latest=0.02)
        assert board.stop() == ""


def test_the_board_is_there_first(robot: Path, agent: Agent) -> None:
    agent.kill()
    with Board(robot, agent) as board:
        check_board_before_agent(board, longest=5.0)
        assert board.stop() == ""


@pytest.mark.parametrize("pause", [0.0, 2.0])
def test_the_agent_is_restarted(robot: Path, agent: Agent, pause: float) -> None:
    """Even a restart too fast for a timeout is detected.  The control loop is undisturbed, and memory does not grow."""
    with Board(robot, agent) as board:
        board.running()
        check_alive(board, 0.5)
        for number in range(1, 4):
            began, before = board.began(), board.cycles()
            agent.restart(pause)
            assert board.running() - before < 1000 * (6.0 + pause)
            assert board.began() == pytest.approx(began, abs=0.06)
            assert board.next("got_reliable") == 0.5  # the board has kept its setpoint
            assert board.statistic("reconnects") == number
        check_alive(board, 0.75)
        assert board.stop() == ""  # AddressSanitizer has found no leak


def test_frames_that_are_lost_come_again(robot: Path, agent: Agent) -> None:
    """No frame arrives for half a second: reliable messages fill their stream, then the same session continues."""
    with Board(robot, agent) as board:
        board.running()
        agent.from_board.loss = 1.0
        agent.wait_until(lambda: sum(frame.fate == "lost" for frame in agent.log) > 30)
        agent.from_board.loss = 0.0
        board.publishes(75)
        assert len(agent.created) == 1
        agent.wait_until(lambda: abs(board.next("cycles") - board.cycles()) <= 40)
        assert board.stop() == ""


def test_a_serial_line(serial_robot: Path, tmp_path: Path) -> None:
    with Agent(PtyLink(tmp_path / "line")) as agent, Board(serial_robot, agent) as board:
        board.running()
        check_alive(board, 0.5)
        agent.restart(0.5)
        board.running()
        check_alive(board, 0.75)
        assert board.stop() == ""
