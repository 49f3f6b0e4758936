# SPDX-License-Identifier: Apache-2.0
"""Resets of the emulated STM32H743: their causes, and the memory that they keep."""

from __future__ import annotations

import pytest

from tests.doubles.stm32.build import small
from tests.doubles.stm32.machine import POWER_ON, SOFTWARE, WATCHDOG, Machine

RESTART, START_WATCHDOG, FEED, CHANGE_CACHED = range(1, 5)


def _start() -> Machine:
    chip = Machine(small("resets"))
    chip.run_to("main")
    chip.write_word("starts", 0)
    chip.write_word("starts_in_axi", 0)
    chip.run(0.0001)
    return chip


def _do(chip: Machine, command: int) -> None:
    chip.write_word("command", command)
    chip.run_until(lambda: chip.word("command") == 0, step=0.0001)


def test_a_reset_by_software_keeps_memory_and_backup_registers() -> None:
    chip = _start()
    assert chip.word("without_access") == 0
    assert chip.word("causes") == POWER_ON
    _do(chip, RESTART)
    chip.run(0.001)
    assert (chip.word("starts"), chip.backup[3]) == (2, 2)
    assert chip.word("causes") == SOFTWARE
    assert chip.resets == [SOFTWARE]


def test_a_reset_loses_the_changes_in_the_cache() -> None:
    chip = _start()
    _do(chip, CHANGE_CACHED)
    assert chip.word("starts_in_axi") == 1
    _do(chip, RESTART)
    assert chip.word("starts_in_axi") == 0


def test_the_power_takes_memory_and_a_battery_keeps_backup_registers() -> None:
    chip = _start()
    chip.power_cycle(battery=True)
    chip.run(0.001)
    assert chip.backup[3] == 2
    assert chip.word("starts") > 2
    assert chip.word("causes") == POWER_ON
    chip.power_cycle()
    chip.run(0.001)
    assert chip.backup[3] == 1


def test_the_watchdog_resets_in_time() -> None:
    """100 counts of 8 clocks of 32 kHz are 25 ms."""
    chip = _start()
    assert chip.word("has_clock") == 0
    _do(chip, START_WATCHDOG)
    assert chip.word("has_clock") != 0
    begin = chip.seconds
    chip.run_until(lambda: chip.resets != [], step=0.0001)
    assert chip.seconds - begin == pytest.approx(0.025, abs=0.0003)
    chip.run(0.04)
    assert chip.resets == [WATCHDOG], "the reset stops it"
    assert chip.word("causes") == WATCHDOG
    assert chip.word("has_clock") == 0
    _do(chip, START_WATCHDOG)
    _do(chip, FEED)
    chip.run(0.04)
    assert chip.resets == [WATCHDOG]
    assert chip.watchdog.feeds > 100
