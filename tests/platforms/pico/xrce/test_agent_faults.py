# SPDX-License-Identifier: Apache-2.0
"""An agent that restarts, freezes or sends garbage, and an unplugged cable: the board recovers, the loop continues.

FreeRTOS runs only the tests that depend on the scheduling of communication; test_long_freertos_faults.py has the rest.
"""

from __future__ import annotations

from collections.abc import Iterator

import pytest

from tests.platforms.pico.images import PLATFORMS, skip_unless_emulated

from .board import Jiwy
from .scenarios import SCENARIOS, assert_is_back, hold, restart

RESTARTS = 10
ON_FREERTOS = ("cable",)


@pytest.fixture(scope="module", params=PLATFORMS)
def board(request: pytest.FixtureRequest) -> Iterator[Jiwy]:
    skip_unless_emulated(request.param)
    with Jiwy(request.param) as made:
        made.home()
        yield made


def test_restarts(board: Jiwy) -> None:
    hold(board)
    restart(board, RESTARTS)
    assert_is_back(board)


@pytest.mark.parametrize("scenario", SCENARIOS)
def test_it_comes_back(board: Jiwy, scenario: str) -> None:
    if board.platform == "freertos" and scenario not in ON_FREERTOS:
        return  # it is one of the long tests
    hold(board)
    SCENARIOS[scenario](board)
    assert_is_back(board)
