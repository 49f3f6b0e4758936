# SPDX-License-Identifier: Apache-2.0
"""An agent that restarts, freezes or sends garbage, and an unplugged cable: the board recovers, the loop continues."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

from tests.platforms.pico.images import PLATFORMS, skip_unless_emulated

from .board import Jiwy
from .scenarios import SCENARIOS, assert_is_back, hold, restart


@pytest.fixture(scope="module", params=PLATFORMS)
def board(request: pytest.FixtureRequest) -> Iterator[Jiwy]:
    skip_unless_emulated(request.param)
    with Jiwy(request.param) as made:
        made.home()
        yield made


@pytest.mark.parametrize("count", [10, 200])
def test_restarts(board: Jiwy, count: int) -> None:
    """The board finds each new agent, no memory is lost, no control cycle is disturbed."""
    hold(board)
    times = sorted(restart(board, count))
    middle = times[count // 2]
    print(f"{board.platform}: first message {times[0]:.1f} ... {middle:.1f} ... {times[-1]:.1f} ms after the start")
    if count > 100:
        assert times[-1] < 3 * middle + 20, "none takes longer than others"
    assert_is_back(board)


@pytest.mark.parametrize("scenario", SCENARIOS)
def test_it_comes_back(board: Jiwy, scenario: str) -> None:
    hold(board)
    SCENARIOS[scenario](board)
    assert_is_back(board)
