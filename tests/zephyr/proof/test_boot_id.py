# SPDX-License-Identifier: Apache-2.0
"""The number of a start on Zephyr: by the Pico's ring oscillator, and by Zephyr's entropy device on an STM32."""

from __future__ import annotations

from tests.doubles.rp2040.emulator import Emulator

from .board import image, skip_unless_emulated


def test_each_start_of_a_pico_has_another_number() -> None:
    skip_unless_emulated()
    numbers = []
    with Emulator(image()) as pico:
        for _ in range(3):
            pico.run(milliseconds=60)
            numbers.append(pico.word("boot_id"))
            pico.call("reset")
    assert 0 not in numbers
    assert len({*numbers}) == 3
