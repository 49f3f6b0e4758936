# SPDX-License-Identifier: Apache-2.0
"""The emulated STM32H743 itself, by small programs against the headers of ST and Arm."""

from __future__ import annotations

from tests.doubles.stm32.build import small
from tests.doubles.stm32.machine import Machine


def test_interrupts_nest_by_priority_and_masks() -> None:
    """The order that the Armv7-M Architecture Reference Manual (DDI 0403E, B1.5) gives."""
    chip = Machine(small("nesting"))
    chip.run_until(lambda: chip.word("ended") == 1, longest=0.1)
    data = bytes(chip.processor.cpu.mem_read(chip.symbols["events"], chip.word("length")))
    assert data.decode() == "MHhmLl1" + "2Hh3" + "MHhmLl4" + "5Hh6" + "S7"
    assert chip.word("unexpected_exception") == 0
    assert chip.processor.nvic.active == 0


def test_a_timer_interrupts_sums_of_doubles() -> None:
    """Every millisecond, for 0.2 s; the registers of the FPU of both sides stay."""
    chip = Machine(small("first"))
    chip.run_to("main")
    chip.run(0.2)
    ticks = chip.word("ticks")
    assert ticks in (199, 200)
    assert chip.word("wrong") == 0
    assert chip.word("rounds") > 10_000
    assert chip.word("unexpected_exception") == 0
    assert chip.interrupts(54) == ticks


def test_a_uart_sends_back_what_it_receives() -> None:
    """Three bytes, each one later, in the time of ten bits at 115200 baud."""
    chip = Machine(small("first"))
    chip.run_to("main")
    chip.run(0.001)
    chip.uarts[3].line.send(b"abc")
    chip.run(2.5 * 10 / 115200)
    assert chip.uarts[3].line.take() == b"b"
    chip.run(0.001)
    assert chip.uarts[3].line.take() == b"cd"


def test_bytes_at_another_baud_rate_are_not_understood() -> None:
    chip = Machine(small("first"))
    chip.run_to("main")
    chip.run(0.001)
    chip.uarts[3].line.baud = 57600
    chip.uarts[3].line.send(b"abc")
    chip.run(0.01)
    assert chip.uarts[3].line.take() == b""
