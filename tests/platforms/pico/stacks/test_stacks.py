# SPDX-License-Identifier: Apache-2.0
"""Each stack is a quarter larger than the largest use by JIWY's RP2040 images with the compiler's doubles."""

from __future__ import annotations

import pytest

from tests.doubles.rp2040.emulator import Emulator
from tests.platforms.pico.closed_loop.board import image
from tests.platforms.pico.images import PLATFORMS, images, skip_unless_emulated
from tests.platforms.pico.stacks.workload import worst_of
from tests.platforms.pico.test_faults import FAULT, MODEL, order

SEED = 4
"""Of the first six seeds, this one nests exceptions deepest."""
EMERGENCY_STACKS = "epg_pico_emergency_stacks"


@pytest.mark.parametrize("platform", PLATFORMS)
def test_a_quarter_is_left(platform: str) -> None:
    skip_unless_emulated(platform)
    stacks = worst_of(image(platform), SEED)
    kernel = {"uxIdleTaskStack", "uxTimerTaskStack"} if platform == "freertos" else set()
    assert set(stacks) == {"control", "communication", "main"} | kernel
    assert stacks["communication"].used > 700, "the work is hard"
    assert {name: stack for name, stack in stacks.items() if stack.used * 5 > stack.size * 4} == {}


@pytest.mark.parametrize("core", [0, 1])
@pytest.mark.parametrize("platform", PLATFORMS)
def test_a_quarter_is_left_of_the_stack_for_faults(platform: str, core: int) -> None:
    """The unused part of each half still has the value that it was cleared to at the start."""
    skip_unless_emulated(platform)
    with Emulator(images("pico", platform, "user_bench") / "user_bench.elf") as pico:
        pico.run(milliseconds=20)
        memory = pico.read(EMERGENCY_STACKS)
        size = len(memory) // 2
        assert not any(memory)
        if core == 0:
            order(pico, FAULT, milliseconds=10)
        else:
            pico.write_word(MODEL + "fault", 1)
            pico.run(milliseconds=10)
        memory = pico.read(EMERGENCY_STACKS)
        halves = memory[:size], memory[size:]
        used = [size - next((at for at, byte in enumerate(half) if byte), size) for half in halves]
        assert used[core] > 0
        assert max(used) * 5 <= size * 4
