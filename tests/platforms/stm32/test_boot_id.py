# SPDX-License-Identifier: Apache-2.0
"""The number of a start is a word of the chip's random number generator, whose clocks are left as they were."""

from __future__ import annotations

import pytest

from tests.doubles.stm32 import f767
from tests.doubles.stm32.clocks import AHB2ENR, CR, RNGEN
from tests.doubles.stm32.f767 import Stm32f767
from tests.doubles.stm32.machine import Machine
from tests.doubles.stm32.rng import CR as RNG_CR
from tests.doubles.stm32.rng import ENABLED
from tests.doubles.toolchain import skip_if_missing, unicorn
from tests.platforms.stm32.console import ask, boot
from tests.platforms.stm32.images import images

HSI48ON = 1 << 12


def machine(board: str) -> Machine:
    skip_if_missing(unicorn)
    kind = Stm32f767 if board == "nucleo_f767zi" else Machine
    return kind(images("bare_metal", "console", board) / "jiwy_firmware.elf", clocks=4)


@pytest.mark.parametrize("board", ["nucleo_h743zi", "nucleo_f767zi"])
def test_each_start_has_another_number(board: str) -> None:
    chip = machine(board)
    numbers = []
    for _ in range(3):
        boot(chip)
        numbers.append(chip.word("boot_id"))
        assert "ok version" in ask(chip, "version")
        chip.power_cycle()
    assert numbers == chip.rng.words
    assert len({*numbers}) == 3


def test_the_clocks_are_off_again() -> None:
    chip = machine("nucleo_h743zi")
    boot(chip)
    assert len(chip.rng.words) == 1
    assert not chip.clocks.registers[CR] & HSI48ON
    assert not chip.clocks.enabled(AHB2ENR, RNGEN)


def test_a_generator_that_the_program_uses_goes_on() -> None:
    chip = machine("nucleo_h743zi")
    chip.run_to("main")
    chip.clocks.registers[CR] |= HSI48ON
    chip.clocks.registers[AHB2ENR] = 1 << RNGEN
    chip.rng.write(RNG_CR, ENABLED)
    chip.run(0.03)
    assert [chip.word("boot_id")] == chip.rng.words
    assert chip.clocks.registers[CR] & HSI48ON
    assert chip.clocks.enabled(AHB2ENR, RNGEN)
    assert chip.rng.read(RNG_CR) == ENABLED


def test_without_a_clock_for_the_generator_the_target_starts_all_the_same(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(f767.ClocksOfF767, "random", 0)
    chip = machine("nucleo_f767zi")
    boot(chip)
    assert chip.rng.words == []
    assert chip.word("boot_id") != 0
    assert "ok version" in ask(chip, "version")
