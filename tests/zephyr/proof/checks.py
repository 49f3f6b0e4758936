"""What must hold of Zephyr's control loop on a Pico, whatever its communication does."""

from __future__ import annotations

from tests.emulator.emulator import CYCLES_PER_MILLISECOND
from tests.platforms.pico.closed_loop.robot import PERIOD
from tests.platforms.pico.xrce.checks import assert_nothing_counted

from .board import ZephyrJiwy, deviations

LATEST = 20 * CYCLES_PER_MILLISECOND // 1000
"""Cycles by which the control cycle, and its first reading, may begin later than the earliest do: 20 us."""
LATEST_WRITE = 530 * CYCLES_PER_MILLISECOND // 1000
"""Cycles from the begin of the control cycle, 7 us after its tick, to the end of its last write to an output: they may
begin at 500 us from the tick, and the PWM wraps at 550 us."""


def assert_undisturbed(jiwy: ZephyrJiwy) -> dict[str, str]:
    """Since begin(): no cycle lost or late, all outputs act at the same PWM wrap; the console's statistics."""
    stats = assert_nothing_counted(jiwy)
    timing = jiwy.timing()
    assert timing.cycles > 300
    assert timing.missed == 0
    assert max(timing.entry) - min(timing.entry) < LATEST
    assert max(timing.first_read) - min(timing.first_read) < LATEST
    assert set(timing.actuation) == {0}, "no level has acted at another wrap"
    assert max(timing.written) < LATEST_WRITE
    assert max(deviations(jiwy.interrupts(), PERIOD)) < LATEST
    assert jiwy.faults() == []
    assert jiwy.pico.run(cycles=1)["resets"] == []
    return stats
