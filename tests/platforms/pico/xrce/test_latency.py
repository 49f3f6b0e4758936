# SPDX-License-Identifier: Apache-2.0
"""From a setpoint at the agent to the level of the PWM: the next control cycle, at one instant of it."""

from __future__ import annotations

import pytest

from tests.emulator.toolchain import skip_if_missing
from tests.platforms.pico.images import PLATFORMS, skip_unless_emulated
from tests.platforms.pico.timing.checks import LARGEST_ENTRY
from tests.xrce_agent.bare import libraries
from tests.xrce_agent.latency import PERIOD

from .agent import CLOCK
from .latency import measure, programs

WRAP = 50e-6
"""Seconds of a period of the output's PWM, at the begin of which a level that was written acts."""
ENTRY = 15
"""Clock cycles from the tick to its handler's first instruction, from which the step counts."""
READ = 15e-6
"""Seconds of a cycle until it has taken its setpoints."""
USB = 0.003
"""Seconds that a frame takes to the control side at most: two frames of USB, and a poll of communication."""
STEPS = 60


@pytest.mark.parametrize("platform", PLATFORMS)
def test_the_next_cycle(platform: str) -> None:
    skip_unless_emulated(platform)
    skip_if_missing(libraries)
    for delay, image in programs(platform).items():
        steps = measure(image, STEPS)
        acts = 1e-6 * delay + WRAP
        (instant,) = {round(step.in_cycle * CLOCK) for step in steps}  # the same in each cycle
        assert abs(instant - (acts * CLOCK - ENTRY)) <= LARGEST_ENTRY
        assert {step.cycles for step in steps} <= {0, 1}
        assert all(step.after_arrival >= acts - READ for step in steps if step.cycles == 0)
        assert all(step.after_arrival <= PERIOD + acts for step in steps)
        assert max(step.whole for step in steps) < USB + PERIOD + acts
