# SPDX-License-Identifier: Apache-2.0
"""Checks of a running board, for all middlewares that use an agent."""

from __future__ import annotations

import itertools
import statistics
import time
from collections.abc import Sequence

import pytest

from tests.doubles.xrce_agent import Agent

from .board import Board

FLOAT64 = "std_msgs::msg::dds_::Float64_"


def check_alive(board: Board, value: float) -> None:
    """Both directions work: a setpoint reaches the model, and the model's answer comes back."""
    board.agent.wait_until(lambda: board.set("reliable", value) >= 1 and board.values("got_reliable")[-1:] == [value])


def check_topics(agent: Agent) -> None:
    """The agent's only client has the topics of the robot, with their types and quality of service."""
    (client,) = agent.clients.values()
    reliable = {"reliable", "got_reliable", "cycles"}
    others = {"quick", "held", "zeroed", "got_quick", "got_held", "got_zeroed", "cycles_too"}
    assert {(end.topic, end.type, end.reliable) for end in client.ends.values() if end.topic.startswith("rt/")} == {
        *((f"rt/lab/{topic}", FLOAT64, topic in reliable) for topic in reliable | others),
        ("rt/diagnostics", "diagnostic_msgs::msg::dds_::DiagnosticArray_", True),
        ("rt/lab/robot_1/enable", "std_msgs::msg::dds_::Bool_", True),
    }


def check_end_of_session(board: Board) -> None:
    """The board closes its session when it ends, and has sent nothing malformed."""
    assert board.stop() == ""
    board.agent.wait_until(lambda: board.agent.clients == {})
    assert board.agent.malformed == 0


def check_period(board: Board, error: float) -> list[float]:
    """In 2 s, the mean distance of publications is 20 ms, give or take ``error`` ms.

    Publications of one turn are of one control cycle.  Returns the distances in control cycles of 1 ms.
    """
    since = board.topics.count
    board.passes(2000)
    reliable, quick = board.values("cycles", since), board.values("cycles_too", since)
    steps = [after - before for before, after in itertools.pairwise(quick)]
    assert statistics.mean(steps) == pytest.approx(20, abs=error)
    assert set(reliable) >= set(quick[1:-2])
    return steps


def check_newest_setpoints(board: Board) -> None:
    for topic in ("reliable", "quick"):
        for number in range(200):
            assert board.set(topic, 1.0 + number / 256) == 1
        board.wait_for(f"got_{topic}", 1.0 + 199 / 256)
        assert {board.next(f"got_{topic}") for _ in range(5)} == {1.0 + 199 / 256}


def check_wrong_setpoints(board: Board, malformed: Sequence[bytes]) -> None:
    """Numbers that are not finite are dropped, two ``malformed`` messages are counted, and later setpoints arrive."""
    board.set("reliable", 0.5)
    board.wait_for("got_reliable", 0.5)
    for value in (float("nan"), float("inf"), float("-inf")):
        board.set("reliable", value)
    for data in malformed:
        board.topics.publish("rt/lab/quick", data)
    board.set("quick", 0.75)
    board.wait_for("got_quick", 0.75)
    board.agent.wait_until(lambda: board.statistic("setpoints_dropped") == 3)
    diagnostics = board.diagnostics()
    assert (diagnostics.values["malformed"], diagnostics.level) == (str(len(malformed)), "WARN")
    assert "; refused setpoints; malformed messages" in diagnostics.message
    assert board.values("got_reliable")[-1] == 0.5


def check_stamps(board: Board, offset: float, earliest: float, latest: float) -> None:
    """Stamps follow the agent's clock, which is ``offset`` s ahead.  They are of the control cycle."""

    def error() -> float:
        return board.diagnostics().stamp - (time.time() + offset)  # the clock of the agent, which stamps follow

    board.agent.wait_until(lambda: abs(error()) < 1.0)
    errors = [error() for _ in range(5)]
    assert earliest < max(errors) <= latest, f"{errors}: a late computer reads a stamp later"


def check_board_before_agent(board: Board, longest: float) -> None:
    """The agent, which is stopped, starts later than the board.  The board publishes after at most ``longest`` s."""
    time.sleep(1.0)  # no agent is there that could hear the board's time
    board.agent.start()
    assert board.running() < 1000 * (1.0 + longest)
    check_alive(board, 0.5)
    assert board.next("cycles") > 1000  # the model has run meanwhile
    assert board.statistic("reconnects") == 0
