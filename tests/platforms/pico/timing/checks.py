# SPDX-License-Identifier: Apache-2.0
"""The promises about the timing of EPG's images."""

from __future__ import annotations

from tests.platforms.pico.closed_loop.robot import MOTOR_PERIOD

from .measure import Timing

LARGEST_ENTRY = 3
"""Cycles of 8 ns by which the handler of a tick may begin early or late."""
LARGEST_SECOND_READ = 1250
"""The same for the read of the second encoder: before it, the first one's position is computed in doubles."""


def assert_on_time(timing: Timing) -> None:
    assert timing.missed == timing.overruns == 0
    assert max(map(abs, timing.entry)) <= LARGEST_ENTRY
    assert max(map(abs, timing.first_read)) <= LARGEST_ENTRY
    assert max(map(abs, timing.last_read)) <= LARGEST_SECOND_READ
    assert sum(timing.actuation.values()) > timing.cycles // 4, "outputs have changed"
    assert all(deviation % MOTOR_PERIOD == 0 for deviation in timing.actuation), "levels act at wraps"
