# SPDX-License-Identifier: Apache-2.0
"""A model that is initialised again runs as it did first; RP2040 images in the emulator.

The model never resets its variables.  The SDK's linker script and start-up code place and initialise them.
"""

from __future__ import annotations

import pytest

from tests.doubles.rp2040.emulator import Emulator
from tests.platforms.pico.images import PLATFORMS, images, skip_unless_emulated

RUNS = 3
CYCLES = 100
ENABLED_WITHIN = 30
"""Cycles, until the console has handled the command."""


def outputs(pico: Emulator, count: int) -> list[bytes]:
    """The model's outputs in the next cycles.  They differ from cycle to cycle."""
    seen: list[bytes] = []
    while len(seen) < count:
        pico.run(milliseconds=0.5)
        value = pico.read("worn_outputs", 8)
        if value != bytes(8) and value not in seen[-1:]:
            seen.append(value)
    return seen


@pytest.mark.parametrize("platform", PLATFORMS)
def test_each_run_is_the_first(platform: str) -> None:
    skip_unless_emulated(platform)
    elf = images("pico", platform, "worn_firmware") / "worn_firmware.elf"
    with Emulator(elf, usb={"seed": 3}) as pico:
        first = outputs(pico, CYCLES)
        assert len(set(first)) == CYCLES
        pico.run(milliseconds=2000, configured=True)
        pico.run(milliseconds=20)
        for _ in range(RUNS - 1):
            pico.send("\ndisable\n")
            pico.run_until_text("ok disable", milliseconds=100)
            pico.send("enable\n")
            again = outputs(pico, CYCLES + ENABLED_WITHIN)
            start = again.index(first[0])
            assert again[start : start + CYCLES] == first
        assert pico.call("faults") == []
