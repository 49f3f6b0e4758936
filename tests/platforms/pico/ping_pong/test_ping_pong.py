# SPDX-License-Identifier: Apache-2.0
"""``examples/ping_pong`` on an emulated Pico: each ping has an answer at once, the control loop is undisturbed."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

from tests.doubles.toolchain import skip_if_missing
from tests.doubles.xrce_agent.bare import libraries
from tests.platforms.pico.closed_loop.robot import PERIOD
from tests.platforms.pico.images import PLATFORMS, skip_unless_emulated
from tests.platforms.pico.timing.checks import LARGEST_ENTRY

from .round_trip import Board, Combination, Run, programs, summarise, table

BOTH: tuple[Combination, ...] = (("best", "best"), ("default", "default"))
LONGEST = 0.0025
"""In seconds: two polls of communication, of at most 1 ms each, and USB's packets."""
PINGS = 60


@pytest.fixture(scope="module", params=PLATFORMS)
def platform(request: pytest.FixtureRequest) -> str:
    skip_unless_emulated(request.param)
    skip_if_missing(libraries)
    return str(request.param)


@pytest.fixture(params=BOTH, ids="/".join)
def board(request: pytest.FixtureRequest, platform: str) -> Iterator[Board]:
    with Board(programs(platform, BOTH)[request.param], request.param) as made:
        yield made


def test_every_ping_comes_back(board: Board) -> None:
    board.pico.call("watch_span", name="tick", core=1, **{"from": "on_wrap", "to": "return"})
    runs = [board.measure(0.0, PINGS, "flat out"), board.measure(30.0, PINGS // 4, "30 Hz")]
    assert_on_time(runs)
    assert board.burst(4) == [1.0, 2.0, 3.0, 4.0]
    entries = [passage[0] for passage in board.pico.call("span", name="tick")["passages"]]
    assert len(entries) > 500
    assert max(abs(entry - entries[0] - k * PERIOD) for k, entry in enumerate(entries)) <= LARGEST_ENTRY
    assert board.pico.call("faults") == []
    print(table([summarise(run) for run in runs]))


def assert_on_time(runs: list[Run]) -> None:
    for run in runs:
        assert run.lost == 0
        assert min(run.times) > 0.0 and max(run.times) < LONGEST
