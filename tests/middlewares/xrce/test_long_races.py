# SPDX-License-Identifier: Apache-2.0
"""All data that the control loop and the middleware share, with ThreadSanitizer."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.doubles.xrce_agent import Agent

from .board import Board
from .conftest import build


@pytest.fixture(scope="module")
def robot_for_races(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return build("robot", tmp_path_factory.mktemp("xrce_races"), "-O1 -g -fsanitize=thread") / "robot_host"


def test_both_sides_race_for_nothing(robot_for_races: Path, agent: Agent, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("TSAN_OPTIONS", "halt_on_error=1 exitcode=66")
    with Board(robot_for_races, agent) as board:
        for turn in range(10):
            board.running()
            for number in range(20):
                board.set("reliable", number / 32)
                board.set("quick", number / 32)
            board.wait_for("got_quick", 19 / 32)
            board.enable(turn % 2 == 1)
            board.diagnostics()
            agent.restart()
        assert board.stop() == ""
