# SPDX-License-Identifier: Apache-2.0
"""Random interrupts have the same order and registers on the emulated STM32H743 as on QEMU's Cortex-M7."""

from __future__ import annotations

import struct
from pathlib import Path

from tests.doubles.mps2.qemu import Board, qemu, receive
from tests.doubles.stm32.build import small
from tests.doubles.stm32.machine import Machine
from tests.doubles.toolchain import skip_if_missing
from tests.platforms.firmware.free_running import ICOUNT

MPS2 = Path(__file__).resolve().parents[1] / "firmware" / "mps2" / "mps2.ld"
LIMIT = 120_000
"""Words of the log in ``traces.c``."""
BASIC_FRAME = 0x10
"""Bit of EXC_RETURN: the frame has no registers of the FPU."""


def _emulated() -> tuple[int, ...]:
    chip = Machine(small("traces"))
    chip.run_until(lambda: chip.word("ended") == 1, longest=10)
    assert (chip.word("ended"), chip.word("wrong_registers"), chip.word("unexpected_exception")) == (1, 0, 0)
    count = chip.word("length")
    return struct.unpack(f"<{count}I", chip.processor.cpu.mem_read(chip.symbols["trace"], 4 * count))


def _by_qemu() -> tuple[int, ...]:
    with Board("mps2-an500", small("traces", mps2=MPS2), uarts=1, options=ICOUNT) as board:
        (count,) = struct.unpack("<I", receive(board.lines[0], 4))
        return struct.unpack(f"<{count}I", receive(board.lines[0], 4 * count))


def test_random_interrupts_agree_with_qemu() -> None:
    skip_if_missing(qemu)
    emulated, expected = _emulated(), _by_qemu()
    first = next((at for at, words in enumerate(zip(emulated, expected)) if words[0] != words[1]), len(expected))
    shown = slice(max(0, first - 12), first + 4)
    assert [f"{word:08x}" for word in emulated[shown]] == [f"{word:08x}" for word in expected[shown]], first
    links = [word & 0xFF for word in emulated if word >> 8 == 0xE00000]
    assert {bool(link & BASIC_FRAME) for link in links} == {True, False} and 0xF1 in links and 0xF9 in links
    assert len(links) > 3000 and len(emulated) < LIMIT
