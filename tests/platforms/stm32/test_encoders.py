# SPDX-License-Identifier: Apache-2.0
"""Encoders on timers with 16 bits, on the emulated STM32H743: a movement or a time that is too long is a fault."""

from __future__ import annotations

import pytest

from tests.doubles.stm32.agenda import UNITS
from tests.doubles.stm32.machine import Machine
from tests.platforms.stm32.console import ask, start, stats
from tests.platforms.stm32.images import PLATFORMS

HALF = 0x8000


def at_rest(platform: str, name: str) -> Machine:
    """A disabled target, so that no motion guard looks at the shaft."""
    chip = start(platform, name)
    chip.attach("TIM4", ("D", 12), ("D", 13), alternate_function=2)
    ask(chip, "disable")
    return chip


def counts(chip: Machine) -> int:
    """The counter of TIM4, extended."""
    return chip.word("decoders", offset=16 * 3 + 8, signed=True)


@pytest.mark.parametrize("platform", PLATFORMS)
@pytest.mark.parametrize("way", [1, -1])
def test_a_counter_that_moves_too_far_between_two_readings_is_a_fault(platform: str, way: int) -> None:
    chip = at_rest(platform, "jiwy")
    for _ in range(4):
        chip.turn("TIM4", way * (HALF - 1))
        chip.run(0.002)
    assert counts(chip) == way * 4 * (HALF - 1)
    assert stats(chip)["fault"] == "none"
    for moved in (HALF + 1, 2 * HALF, 3 * HALF):
        chip.turn("TIM4", way * moved)
        chip.run(0.002)
        found = stats(chip)
        assert (found["fault"], found["component"]) == ("sensor", "encoder_pan"), moved
        ask(chip, "enable")
        assert stats(chip)["fault"] == "none"
        ask(chip, "disable")


@pytest.mark.parametrize("platform", PLATFORMS)
def test_a_time_without_readings_that_is_too_long_for_max_speed_is_a_fault(platform: str) -> None:
    chip = at_rest(platform, "fast")
    chip.stall(chip.now + UNITS * 2 // 1000)
    chip.run(0.01)
    found = stats(chip)
    assert found["fault"] == "none" and int(found["missed"]) >= 1
    chip.stall(chip.now + UNITS * 5 // 1000)
    chip.run(0.01)
    found = stats(chip)
    assert (found["fault"], found["component"]) == ("gap", "encoder_pan")
    ask(chip, "enable")
    assert stats(chip)["fault"] == "none"
