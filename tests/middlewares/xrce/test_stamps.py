# SPDX-License-Identifier: Apache-2.0
"""Stamps are of the agent's clock, over any distance, or 0: never of the board's own time."""

from __future__ import annotations

import itertools
import time
from pathlib import Path

import pytest

from tests.doubles.xrce_agent import Agent, Diagnostics, read_diagnostics
from tests.doubles.xrce_agent.wire import Id

from .board import Board
from .checks import check_stamps

TOPIC = "rt/diagnostics"
CONNECTING = 60.0
"""Longest time in seconds until the first diagnostics: each entity of the board takes a round trip."""
AHEAD = 1000.0
"""Seconds by which the agent's clock is ahead."""


def test_stamps_are_of_the_agents_clock(robot: Path, agent: Agent) -> None:
    agent.clock_offset = AHEAD
    with Board(robot, agent) as board:
        board.running()
        check_stamps(board, AHEAD, earliest=-0.1, latest=0.01)
        assert board.stop() == ""


@pytest.mark.parametrize(
    ("there", "back"), [(0.005, 0.005), (0.03, 0.03), (0.15, 0.15), (0.3, 0.3), (0.01, 0.2)], ids=lambda way: f"{way}s"
)
def test_stamps_over_a_distance(robot: Path, agent: Agent, there: float, back: float) -> None:
    """Every stamp of a session, also the first one, is right within the uncertainty that the board states."""
    agent.clock_offset = AHEAD
    agent.from_board.delay, agent.to_board.delay = (there, there), (back, back)
    with Board(robot, agent) as board:
        board.topics.wait_for_sample(TOPIC, CONNECTING, board.node)
        agent.wait_until(lambda: len(board.topics.samples(TOPIC, 0.0, board.node)) >= 8)
        by_monotonic = time.time() + AHEAD - time.monotonic()
        ahead, told = [], []
        for sample in board.topics.samples(TOPIC, 0.0, board.node):
            diagnostics = read_diagnostics(sample.data)
            uncertainty = int(diagnostics.values["clock_uncertainty_ns"]) / 1e9
            assert (there + back) / 2 <= uncertainty <= (there + back) / 2 + 0.2
            ahead.append(diagnostics.stamp - (sample.time - there + by_monotonic))
            assert ahead[-1] <= uncertainty + 0.005, "it was sent after its control cycle"
            told.append(diagnostics)
        assert max(ahead) >= -uncertainty - 0.1
        assert all(earlier.stamp < later.stamp for earlier, later in itertools.pairwise(told))
        assert {(each.values["clock"], each.values["clock_steps"]) for each in told} == {("set", "0")}
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
