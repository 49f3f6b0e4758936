# SPDX-License-Identifier: Apache-2.0
"""Flash bank 2 of the emulated STM32H743."""

from __future__ import annotations

import pytest

from tests.doubles.stm32.build import small
from tests.doubles.stm32.flash import BANK, DBECCERR, PGSERR, SECTOR
from tests.doubles.stm32.machine import Machine, PowerCut

UNLOCK, ERASE, PROGRAM, READ, READ_GUARDED = range(1, 6)
LAST = BANK + 7 * SECTOR


def _start() -> Machine:
    chip = Machine(small("flash"))
    chip.flash.erase_time = 0.01
    chip.run_to("main")
    chip.run(0.001)
    return chip


def _do(chip: Machine, command: int, address: int = LAST, value: int = 7) -> int:
    """Returns the flags of SR2."""
    for name, number in (("address", address), ("value", value), ("command", command)):
        chip.write_word(name, number)
    chip.run_until(lambda: chip.word("command") == 0, step=0.00001)
    return chip.word("status")


def _read(chip: Machine, address: int = LAST) -> list[int]:
    _do(chip, READ, address)
    return [chip.word("words_read", offset=4 * n) for n in range(8)]


def test_words_are_programmed_once_and_erased() -> None:
    chip = _start()
    assert _do(chip, PROGRAM, value=100) & PGSERR, "the bank is locked"
    assert _read(chip) == [0xFFFFFFFF] * 8
    _do(chip, UNLOCK)
    begin = chip.seconds
    assert not _do(chip, PROGRAM, value=100) & PGSERR
    assert chip.seconds - begin == pytest.approx(100e-6, abs=0.00003)
    assert _read(chip) == list(range(100, 108))
    begin = chip.seconds
    _do(chip, ERASE)
    assert chip.seconds - begin == pytest.approx(0.01, abs=0.00003)
    assert _read(chip) == [0xFFFFFFFF] * 8
    assert chip.flash.operations == [("program", LAST), ("erase", LAST)]


def test_a_second_programming_destroys_the_code_of_a_word() -> None:
    chip = _start()
    _do(chip, UNLOCK)
    _do(chip, PROGRAM, value=100)
    _do(chip, PROGRAM, value=100)
    _read(chip)
    assert chip.word("bus_faults") == 0, "the same data have the same code"
    _do(chip, PROGRAM, value=200)
    _read(chip)
    assert chip.word("bus_faults") == 8
    assert chip.word("status") & DBECCERR
    _do(chip, READ_GUARDED)
    assert chip.word("bus_faults") == 8
    assert chip.word("flags") & 1 << 9, "PRECISERR"
    assert chip.word("status") & DBECCERR
    _do(chip, ERASE)
    assert _read(chip) == [0xFFFFFFFF] * 8


def test_a_wrong_key_locks_until_the_next_reset() -> None:
    chip = _start()
    _do(chip, UNLOCK)
    _do(chip, UNLOCK)
    assert chip.word("bus_faults") == 2
    assert _do(chip, PROGRAM) & PGSERR


@pytest.mark.parametrize("operation", [1, 2, 3])
def test_power_is_cut_in_any_operation(operation: int) -> None:
    """An erasure, then two words: what was before stays, and the word in hand is damaged."""
    chip = _start()
    _do(chip, UNLOCK)
    _do(chip, PROGRAM, LAST + 32, 300)
    chip.flash.cut_power_in(operation)
    with pytest.raises(PowerCut):
        _do(chip, ERASE)
        _do(chip, PROGRAM, LAST, 100)
        _do(chip, PROGRAM, LAST + 32, 200)
    with pytest.raises(PowerCut):
        chip.run(0.1)
    chip.power_cycle()
    chip.run_to("main")
    chip.run(0.001)
    assert chip.flash.damaged <= {LAST + 32} if operation == 1 else chip.flash.damaged == {LAST + 32 * (operation - 2)}
    for word in (LAST, LAST + 32):
        before = chip.word("bus_faults")
        data = _read(chip, word)
        if word in chip.flash.damaged:
            assert chip.word("bus_faults") == before + 8
        else:
            assert data in ([0xFFFFFFFF] * 8, list(range(100, 108)), list(range(300, 308)))
    assert chip.word("unexpected_exception") == 0
