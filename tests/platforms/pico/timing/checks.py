# SPDX-License-Identifier: Apache-2.0
"""What must hold of the timing of EPG's images."""

from __future__ import annotations

from tests.platforms.pico.closed_loop.robot import MOTOR_PERIOD

from .measure import Timing

LARGEST_ENTRY = 3
"""Cycles of 8 ns by which a tick's handler may begin early or late."""
LARGEST_SECOND_READ = 1250
"""And by which the second encoder may be read: the first one's position is computed before, in doubles."""


def assert_on_time(timing: Timing) -> None:
    assert timing.missed == timing.overruns == 0
    assert max(map(abs, timing.entry)) <= LARGEST_ENTRY
    assert max(map(abs, timing.first_read)) <= LARGEST_ENTRY
    assert max(map(abs, timing.last_read)) <= LARGEST_SECOND_READ
    assert sum(timing.actuation.values()) > timing.cycles // 4, "outputs have changed"
    assert all(deviation % MOTOR_PERIOD == 0 for deviation in timing.actuation), "levels act at wraps"
