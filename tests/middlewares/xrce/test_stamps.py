# SPDX-License-Identifier: Apache-2.0
"""Stamps are of the agent's clock or 0, never of the board's own time.  ``c/session_tests.c`` judges them exactly."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.doubles.xrce_agent import Agent, Diagnostics
from tests.doubles.xrce_agent.wire import Id

from .board import Board
from .checks import check_stamps

AHEAD = 1000.0
"""Seconds by which the agent's clock is ahead."""


def test_stamps_are_of_the_agents_clock(robot: Path, agent: Agent) -> None:
    agent.clock_offset = AHEAD
    with Board(robot, agent) as board:
        board.running()
        check_stamps(board, AHEAD, earliest=-0.1, latest=0.01)
        assert board.stop() == ""


def test_without_the_agents_time_stamps_are_0(robot: Path, agent: Agent) -> None:
    """And the diagnostics say so."""
    agent.mute.add(Id.TIMESTAMP)
    with Board(robot, agent) as board:
        board.running()
        first = board.diagnostics()
        assert (first.stamp, first.level, first.values["clock"]) == (0.0, "WARN", "not set")
        assert "; clock not set" in first.message
        assert board.values("cycles"), "a message without a stamp does not wait"
        agent.mute.clear()
        agent.wait_until(lambda: board.diagnostics().values["clock"] == "set")
        check_stamps(board, 0.0, earliest=-0.1, latest=0.01)
        assert board.stop() == ""


def test_an_agent_whose_clock_is_set_back_an_hour(robot: Path, agent: Agent) -> None:
    agent.clock_offset = AHEAD
    with Board(robot, agent) as board:
        board.running()
        assert board.diagnostics().values["clock_steps"] == "0"
        agent.clock_offset -= 3600.0
        stepped: list[Diagnostics] = []

        def has_stepped() -> bool:
            stepped.append(board.diagnostics())
            return stepped[-1].values["clock_steps"] == "1"

        agent.wait_until(has_stepped)
        assert stepped[-1].level == "WARN" and "; step of the clock" in stepped[-1].message
        assert int(stepped[-1].values["clock_step_ms"]) == pytest.approx(-3_600_000, abs=200)
        check_stamps(board, AHEAD - 3600.0, earliest=-0.1, latest=0.01)
        assert board.stop() == ""
