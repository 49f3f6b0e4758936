# SPDX-License-Identifier: Apache-2.0
"""Ticks, encoder reads and outputs of JIWY's RP2040 images are at t0 + k T, measured by the emulator."""

from __future__ import annotations

import pytest

from tests.platforms.pico.closed_loop.robot import MOTOR_PERIOD, PERIOD
from tests.platforms.pico.images import PLATFORMS, skip_unless_emulated

from .checks import assert_on_time
from .measure import Load, Timing, evaluate, measure
from .programs import Program

BUSIEST = (Load(1), Load(33, flooded=True))


@pytest.fixture(scope="module", params=PLATFORMS)
def timings(request: pytest.FixtureRequest) -> dict[Load, Timing]:
    """One second of each of the two loads that keep core 0 busiest."""
    skip_unless_emulated(request.param)
    return {load: measure(Program(request.param, load.period), load, seed=1, seconds=1.0) for load in BUSIEST}


def test_ticks_and_encoders_are_on_time(timings: dict[Load, Timing]) -> None:
    for timing in timings.values():
        assert timing.cycles > 900
        assert_on_time(timing)


def test_outputs_act_at_the_same_instant_of_every_cycle(timings: dict[Load, Timing]) -> None:
    for timing in timings.values():
        assert set(timing.actuation) == {0}


def test_usb_was_flooded(timings: dict[Load, Timing]) -> None:
    assert timings[Load(33, flooded=True)].received > 100_000, "bytes in a second"


def passages(*starts: int, length: int = 100) -> list[list[int]]:
    return [[start, length, 50] for start in starts]


def test_what_is_late_is_found() -> None:
    """The third of four ticks is 7 cycles late, the fifth is missing; the last output acts one wrap later."""
    ticks = [1000, 1000 + PERIOD, 1007 + 2 * PERIOD, 1000 + 3 * PERIOD, 1000 + 5 * PERIOD]
    reads = [tick + offset for tick in ticks for offset in (10, 30)]
    taken = [[tick + MOTOR_PERIOD, 1, 5, 0, 6249, 1] for tick in (*ticks[:2], ticks[2] - 7, ticks[3])]
    taken.append([ticks[4] + 2 * MOTOR_PERIOD, 1, 6, 0, 6249, 1])
    spans = passages(*ticks, length=200), passages(*reads, length=10), passages(*(t + 60 for t in ticks))
    timing = evaluate(*spans, taken)
    assert timing.missed == 1
    assert timing.entry == {0: 4, 7: 1}
    assert timing.first_read == {0: 4, 7: 1}
    assert timing.last_read == {0: 4, 7: 1}
    assert timing.written == {160: 4, 167: 1}
    assert timing.actuation == {0: 4, MOTOR_PERIOD: 1}
