# SPDX-License-Identifier: Apache-2.0
"""Communication on core 0 polls about every millisecond, whatever arrives, and no tick of core 1 is late meanwhile."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import pytest

from tests.doubles.rp2040.emulator import CYCLES_PER_MILLISECOND
from tests.platforms.pico.images import PLATFORMS, skip_unless_emulated

from .measure import CHANGE_MS, Polls, measure_live, measure_uart, measure_usb

LONGEST = CYCLES_PER_MILLISECOND * 12 // 10
"""A millisecond, and 0.2 ms on FreeRTOS for a long line of the console while every line is full."""
MILLISECONDS = 150


@pytest.mark.parametrize("measure", [measure_usb, measure_uart])
@pytest.mark.parametrize("platform", PLATFORMS)
def test_within_a_millisecond(platform: str, measure: Callable[[str, int], Iterator[Polls]]) -> None:
    skip_unless_emulated(platform)
    for polls in measure(platform, MILLISECONDS):
        assert polls.faults == 0
        assert polls.longest <= LONGEST, polls
        assert polls.ticks >= MILLISECONDS - 1
        assert polls.deviations == {0}, polls


@pytest.mark.parametrize("platform", PLATFORMS)
def test_a_program_gets_every_row_of_20_signals_in_every_cycle(platform: str) -> None:
    skip_unless_emulated(platform)
    for polls, streamed in measure_live(platform, MILLISECONDS):
        assert polls.faults == 0
        assert polls.longest <= LONGEST, polls
        assert polls.deviations == {0}, polls
        assert streamed.rows >= MILLISECONDS - 2, "the stream begins and ends in the turns after its commands"
        assert (streamed.dropped, streamed.damaged) == (0, 0)
        assert streamed.answers == MILLISECONDS // CHANGE_MS
        assert len(set(streamed.values)) > 1, "the robot moves"
