"""An agent that is restarted, frozen or mad, and a cable that is pulled: the board comes back, the loop goes on.

On FreeRTOS only what has to do with when the service runs; test_long_freertos_faults.py has the rest.
"""

from __future__ import annotations

from collections.abc import Iterator

import pytest

from tests.platforms.pico.images import PLATFORMS, skip_unless_emulated

from .board import Jiwy
from .scenarios import SCENARIOS, assert_is_back, hold, restart

RESTARTS = 20


@pytest.fixture(scope="module", params=PLATFORMS)
def board(request: pytest.FixtureRequest) -> Iterator[Jiwy]:
    skip_unless_emulated(request.param)
    with Jiwy(request.param) as made:
        made.home()
        yield made


@pytest.fixture
def jiwy(board: Jiwy) -> Jiwy:
    hold(board)
    return board


def test_restarts(jiwy: Jiwy) -> None:
    restart(jiwy, RESTARTS)
    assert_is_back(jiwy)


@pytest.mark.parametrize("scenario", SCENARIOS)
def test_it_comes_back(jiwy: Jiwy, scenario: str) -> None:
    if jiwy.platform == "freertos" and scenario in ("garbage", "damage", "flood"):
        return  # in the long tests
    SCENARIOS[scenario](jiwy)
    assert_is_back(jiwy)
