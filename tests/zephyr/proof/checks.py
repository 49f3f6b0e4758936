# SPDX-License-Identifier: Apache-2.0
"""The promises of Zephyr's control loop on a Pico, which must hold for any communication."""

from __future__ import annotations

from tests.doubles.rp2040.emulator import CYCLES_PER_MILLISECOND
from tests.platforms.pico.closed_loop.robot import PERIOD
from tests.platforms.pico.xrce.checks import assert_nothing_counted

from .board import ZephyrJiwy, deviations

LATEST = 20 * CYCLES_PER_MILLISECOND // 1000
"""Cycles by which the tick's interrupt, and its read of the encoders, may begin later than the earliest ones:
20 us."""
LATEST_CYCLE = 100 * CYCLES_PER_MILLISECOND // 1000
"""The same for the control thread's cycle, which computes the model and which other interrupts delay."""
LATEST_WRITE = 535 * CYCLES_PER_MILLISECOND // 1000
"""Cycles from the tick's interrupt to the end of the last write to an output.  Writes may begin 500 us after the tick,
and the PWM wraps at 550 us."""
LONGEST_LOCK = 20 * CYCLES_PER_MILLISECOND // 1000
"""Cycles for which interrupts are locked during a write to outputs: 20 us."""


def assert_undisturbed(jiwy: ZephyrJiwy) -> dict[str, str]:
    """Since begin(): no lost or late cycle, all outputs act at the same PWM wrap; returns the console's statistics."""
    stats = assert_nothing_counted(jiwy)
    timing = jiwy.timing()
    assert timing.cycles > 300
    assert timing.missed == 0
    assert max(timing.entry) - min(timing.entry) < LATEST
    for reads in (timing.first_read, timing.last_read):
        assert max(reads) - min(reads) < LATEST
    assert max(deviations(jiwy.cycles(), PERIOD)) < LATEST_CYCLE
    assert max(jiwy.locked()) < LONGEST_LOCK
    assert set(timing.actuation) == {0}, "no level has acted at another wrap"
    assert max(timing.written) < LATEST_WRITE
    assert max(deviations(jiwy.interrupts(), PERIOD)) < LATEST
    assert jiwy.faults() == []
    assert jiwy.pico.run(cycles=1)["resets"] == []
    return stats
