# SPDX-License-Identifier: Apache-2.0
"""A model that is initialised again runs as it did first; on the emulated STM32, with the model's data in fast memory.

The model never resets its variables.
"""

from __future__ import annotations

import pytest

from tests.doubles.stm32.machine import Machine
from tests.doubles.toolchain import skip_if_missing, unicorn
from tests.platforms.stm32.images import PLATFORMS, images

CYCLES = 100
ENABLED_WITHIN = 30
"""Cycles, until the console has handled the command."""


def outputs(chip: Machine, count: int) -> list[int]:
    """The model's outputs in the next cycles, as bits.  They differ from cycle to cycle."""
    seen: list[int] = []
    while len(seen) < count:
        chip.run(0.0005)
        value = chip.word("worn_outputs", size=8)
        if value != 0 and value not in seen[-1:]:
            seen.append(value)
    return seen


@pytest.mark.parametrize("platform", PLATFORMS)
def test_each_run_is_the_first(platform: str) -> None:
    skip_if_missing(unicorn)
    chip = Machine(images(platform, "console") / "worn_firmware.elf", clocks=4)
    chip.run_to("main")
    first = outputs(chip, CYCLES)
    assert len(set(first)) == CYCLES
    line = chip.uarts[3].line
    for _ in range(2):
        line.take()
        line.send(b"disable\r\n")
        chip.run_until(lambda: b"ok disable" in line.received, longest=0.5)
        line.send(b"enable\r\n")
        again = outputs(chip, CYCLES + ENABLED_WITHIN)
        start = again.index(first[0])
        assert again[start : start + CYCLES] == first
