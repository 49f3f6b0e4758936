# SPDX-License-Identifier: Apache-2.0
"""Bank 2 of the flash: keys, erasure, programming in words of 32 bytes, their codes, and the loss of power on the way.

A word is programmed once after it was erased; a second time with other data destroys its code.  Reading a word with a
wrong code is a bus fault.  Reading the bank waits for the end of an operation.  Programs are in bank 1, whose registers
have no model, nor have the option bytes: their values stay as written.  Code cannot run in bank 2.

Source: RM0433, 4.3 and 4.9; DS12110, flash memory characteristics (times with a parallelism of 64 bits).
"""

from __future__ import annotations

import random
from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

from .agenda import UNITS, Agenda

REGISTERS, BANK, BANK_SIZE, SECTOR, WORD = 0x52002000, 0x08100000, 0x100000, 0x20000, 32
ACR, KEYR, CR, SR, CCR = 0x000, 0x104, 0x10C, 0x110, 0x114
AT_RESET = {ACR: 0x37, CR: 0x31}
KEYS = (0x45670123, 0xCDEF89AB)
LOCK, PG, SER, BER, FW, START = 1, 2, 4, 8, 1 << 6, 1 << 7
BSY, WBNE, QW = 1, 2, 4
EOP, PGSERR, STRBERR, INCERR, DBECCERR = 1 << 16, 1 << 18, 1 << 19, 1 << 21, 1 << 26
FLAGS, INTERRUPT = 0x0FFF0000, 4
ERASED = b"\xff" * WORD


class Surroundings(Protocol):
    """What the flash needs of the machine."""

    agenda: Agenda

    @property
    def now(self) -> int: ...
    def line(self, interrupt: int, source: object, high: bool) -> None: ...
    def stall(self, until: int) -> None: ...
    def bus_error(self, address: int) -> None: ...
    def lose_power(self) -> None: ...


@dataclass
class Operation:
    """A word with its new data, or an erasure of ``size`` bytes without data."""

    address: int
    size: int
    data: bytes | None
    until: int


class Flash:
    """``operations``: all that were begun, as ("program" or "erase", address)."""

    def __init__(self, machine: Surroundings) -> None:
        self.machine = machine
        self.word_time, self.erase_time = 100e-6, 1.0
        """Seconds to program a word, and to erase a sector."""
        self.contents = bytearray(b"\xff" * BANK_SIZE)
        self.programmed: set[int] = set()
        """The addresses of words that were programmed since their erasure."""
        self.damaged: set[int] = set()
        """The addresses of words with a wrong code."""
        self.operations: list[tuple[str, int]] = []
        self._cut: int | None = None
        self._operation: Operation | None = None
        self._start()

    def _start(self) -> None:
        self.registers = dict(AT_RESET)
        self.status = 0
        self._keys = 0
        self._wrong_key = False
        self._buffer: dict[int, int] = {}
        """Bytes of the word that is being written, by their addresses."""

    def reset(self) -> None:
        """Also ends an operation half-way (RM0433, 4.3.9), as the loss of power does."""
        self._break_off()
        self._start()
        self._update()

    def load(self, address: int, data: bytes) -> None:
        """Programs data before the power comes on."""
        self.contents[address - BANK : address - BANK + len(data)] = data
        self.programmed.update(range(address // WORD * WORD, address + len(data), WORD))

    def cut_power_in(self, operations: int) -> None:
        """Cuts the power in the middle of an operation: 1 is the next one."""
        self._cut = len(self.operations) + operations

    # Registers --------------------------------------------------------------------------------------------------------

    def read_register(self, offset: int) -> int:
        if offset == SR:
            busy = BSY | QW if self._operation else 0
            return self.status | busy | (WBNE if self._buffer else 0)
        return 0 if offset in (KEYR, CCR) else self.registers.get(offset, 0)

    def write_register(self, offset: int, value: int) -> None:
        if offset == KEYR:
            self._key(value)
        elif offset == CCR:
            self.status &= ~(value & FLAGS)
        elif offset == CR:
            self._control(value)
        elif offset != SR:
            self.registers[offset] = value
        self._update()

    def _key(self, value: int) -> None:
        if self._wrong_key or not self.registers[CR] & LOCK or value != KEYS[self._keys]:
            self._wrong_key = True  # locked until the next reset
            self.registers[CR] |= LOCK
            self.machine.bus_error(REGISTERS + KEYR)
            return
        self._keys += 1
        if self._keys == len(KEYS):
            self.registers[CR] &= ~LOCK
            self._keys = 0

    def _control(self, value: int) -> None:
        if self.registers[CR] & LOCK:
            return
        self.registers[CR] = value & ~(START | FW)
        if value & START:
            assert not self._operation, "an erasure is started during another operation"
            if value & PG or not value & (SER | BER) or self._buffer:
                self.status |= PGSERR
            elif value & BER:
                self._begin(Operation(BANK, BANK_SIZE, None, self._after(8 * self.erase_time)))
            else:
                sector = BANK + (value >> 8 & 7) * SECTOR
                self._begin(Operation(sector, SECTOR, None, self._after(self.erase_time)))
        elif value & FW and self._buffer:
            word = min(self._buffer) // WORD * WORD
            for address in range(word, word + WORD):
                self._buffer.setdefault(address, 0xFF)
            self._program()

    def _update(self) -> None:
        """Each flag has its enable bit at the same place of CR."""
        self.machine.line(INTERRUPT, self, bool(self.status & self.registers[CR] & FLAGS))

    # Memory -----------------------------------------------------------------------------------------------------------

    def peek(self, address: int, size: int) -> bytes:
        return bytes(self.contents[address - BANK : address - BANK + size])

    def read(self, offset: int, size: int) -> int:
        if self._operation:
            self.machine.stall(self._operation.until)
            self._finish()
        address = BANK + offset
        if any(word in self.damaged for word in (address // WORD * WORD, (address + size - 1) // WORD * WORD)):
            self.status |= DBECCERR
            self._update()
            self.machine.bus_error(address)
        return int.from_bytes(self.peek(address, size), "little")

    def write(self, offset: int, size: int, value: int) -> None:
        if self.registers[CR] & LOCK or not self.registers[CR] & PG:
            self.status |= PGSERR
            self._update()
            return
        for address, byte in enumerate(value.to_bytes(size, "little"), BANK + offset):
            if self._buffer and min(self._buffer) // WORD != address // WORD:
                self.status |= INCERR
                self._buffer.clear()
            elif address in self._buffer:
                self.status |= STRBERR
            self._buffer[address] = byte
            if len(self._buffer) == WORD:
                self._program()
        self._update()

    # Operations -------------------------------------------------------------------------------------------------------

    def _after(self, seconds: float) -> int:
        return self.machine.now + round(seconds * UNITS)

    def _program(self) -> None:
        if self._operation:
            self.machine.stall(self._operation.until)
            self._finish()
        word = min(self._buffer)
        data = bytes(self._buffer[word + n] for n in range(WORD))
        self._buffer.clear()
        self._begin(Operation(word, WORD, data, self._after(self.word_time)))

    def _begin(self, operation: Operation) -> None:
        self._operation = operation
        self.operations.append(("program" if operation.data else "erase", operation.address))
        due: Callable[[], None] = self._finish
        time = operation.until
        if self._cut == len(self.operations):
            due, time = self.machine.lose_power, (self.machine.now + operation.until) // 2
        self.machine.agenda.set(self, time, due)

    def _end(self) -> Operation | None:
        operation, self._operation = self._operation, None
        self.machine.agenda.set(self, None, self._finish)
        return operation

    def _finish(self) -> None:
        if self._cut == len(self.operations):
            self.machine.lose_power()
            return
        operation = self._end()
        assert operation is not None
        words = range(operation.address, operation.address + operation.size, WORD)
        if operation.data is None:
            self.contents[operation.address - BANK : operation.address - BANK + operation.size] = (
                b"\xff" * operation.size
            )
            self.programmed.difference_update(words)
            self.damaged.difference_update(words)
        else:
            word = operation.address
            old = self.peek(word, WORD)
            if word in self.programmed and operation.data != old:
                self.damaged.add(word)
            self.programmed.add(word)
            self.contents[word - BANK : word - BANK + WORD] = bytes(a & b for a, b in zip(old, operation.data))
        self.status |= EOP
        self._update()

    def _break_off(self) -> None:
        """Each word of an erasure is as before, erased, or between; the word that was programmed is between."""
        operation = self._end()
        self._cut = None
        if operation is None:
            return
        chance = random.Random(len(self.operations))
        for word in range(operation.address, operation.address + operation.size, WORD):
            old = self.peek(word, WORD)
            new = bytes(a & b for a, b in zip(old, operation.data)) if operation.data else ERASED
            if old == new:
                continue
            outcome = "between" if operation.data else chance.choice(("old", "new", "between"))
            if outcome == "between":
                mask = chance.randbytes(WORD)
                between = bytes(a & m | b & ~m & 0xFF for a, b, m in zip(old, new, mask))
                self.contents[word - BANK : word - BANK + WORD] = between
                self.programmed.add(word)
                self.damaged.add(word)
            elif outcome == "new":
                self.contents[word - BANK : word - BANK + WORD] = new
                self.programmed.discard(word)
                self.damaged.discard(word)


class Block:
    """The registers."""

    def __init__(self, flash: Flash) -> None:
        self.flash = flash

    def reset(self) -> None:
        self.flash.reset()

    def read(self, offset: int) -> int:
        return self.flash.read_register(offset)

    def write(self, offset: int, value: int) -> None:
        self.flash.write_register(offset, value)
