# SPDX-License-Identifier: Apache-2.0
"""The time from a setpoint at the agent to the PWM level: it acts in the next control cycle, at a fixed time."""

from __future__ import annotations

import pytest

from tests.doubles.toolchain import skip_if_missing, xrce_libraries
from tests.middlewares.xrce.steps import PERIOD
from tests.platforms.pico.images import PLATFORMS, skip_unless_emulated
from tests.platforms.pico.timing.checks import LARGEST_ENTRY

from .agent import CLOCK
from .latency import measure, programs

WRAP = 50e-6
"""Period of the output's PWM in seconds.  A level that was written acts at the start of the next one."""
ENTRY = 15
"""Clock cycles from the tick to its handler's first instruction, from which the step counts."""
READ = 15e-6
"""Seconds from the start of a cycle until it has read its setpoints."""
USB = 0.003
"""Longest time of a frame to the control side in seconds: two frames of USB, and a poll of communication."""
STEPS = 60


@pytest.mark.parametrize("platform", PLATFORMS)
def test_the_next_cycle(platform: str) -> None:
    skip_unless_emulated(platform)
    skip_if_missing(xrce_libraries)
    for delay, image in programs(platform).items():
        steps = measure(image, STEPS)
        acts = 1e-6 * delay + WRAP
        (instant,) = {round(step.in_cycle * CLOCK) for step in steps}  # the same time in each cycle
        assert abs(instant - (acts * CLOCK - ENTRY)) <= LARGEST_ENTRY
        assert {step.cycles for step in steps} <= {0, 1}
        assert all(step.after_arrival >= acts - READ for step in steps if step.cycles == 0)
        assert all(step.after_arrival <= PERIOD + acts for step in steps)
        assert max(step.whole for step in steps) < USB + PERIOD + acts
