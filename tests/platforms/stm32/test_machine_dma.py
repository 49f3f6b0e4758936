# SPDX-License-Identifier: Apache-2.0
"""DMA and the data cache of the emulated STM32H743."""

from __future__ import annotations

import pytest

from tests.doubles.stm32.build import small
from tests.doubles.stm32.machine import Machine

CACHED, CLEAN, DROP, UNCACHED_REGION, IN_DTCM, COPY = 1, 2, 4, 8, 16, 32


def _start(mode: int) -> Machine:
    chip = Machine(small("dma"))
    chip.run_to("main")
    chip.write_word("mode", mode)
    chip.run(0.001)
    return chip


def _echo(chip: Machine, data: bytes) -> bytes:
    """At 1 Mbaud, a byte lasts 10 us."""
    chip.uarts[3].line.send(data)
    chip.run(0.0005 + 20e-6 * len(data))
    return chip.uarts[3].line.take()


@pytest.mark.parametrize("mode", [0, CACHED | CLEAN | DROP, CACHED | UNCACHED_REGION])
def test_a_uart_by_dma_sends_back_what_it_receives(mode: int) -> None:
    """The ring goes round twice; each half and each end of it has its interrupt."""
    chip = _start(mode)
    for number in range(4):
        assert _echo(chip, b"%08d" % number * 4) == bytes(byte + 1 for byte in b"%08d" % number * 4)
    assert (chip.word("halves"), chip.word("completes"), chip.word("errors")) == (2, 2, 0)
    assert chip.cache.hazards == []


def test_without_cleaning_old_bytes_are_sent() -> None:
    chip = _start(CACHED | DROP)
    assert _echo(chip, b"abcd") == bytes(4)


def test_without_invalidating_old_bytes_are_read() -> None:
    chip = _start(CACHED | CLEAN)
    assert _echo(chip, b"abcd") == b"\x01\x01\x01\x01"


def test_memory_at_the_core_ends_a_transfer_with_an_error() -> None:
    chip = _start(IN_DTCM)
    _echo(chip, b"a")
    assert chip.word("errors") == 1
    assert not chip.dma.streams[0].on
    assert len(chip.dma.errors) == 1 and chip.dma.errors[0] >> 17 == 0x20000000 >> 17


def test_memory_is_copied() -> None:
    chip = _start(COPY)
    assert chip.word("copy_done") == 1
    assert [chip.word("copied", offset=4 * n) for n in range(8)] == [1, 2, 3, 4, 5, 6, 7, 8]


def test_a_write_of_dma_to_a_changed_line_is_a_hazard() -> None:
    chip = _start(CACHED | CLEAN | DROP)
    chip.write_word("ring", 0x55, size=1)
    _echo(chip, b"a")
    assert chip.cache.hazards == [chip.symbols["ring"]]
