# SPDX-License-Identifier: Apache-2.0
"""The independent watchdog, and the backup registers of the RTC, whose other registers keep the value that was written.

The clock of the watchdog, LSI, is exact here; ``frequency`` changes it within the data sheet's limits.

Source: RM0433, 45 (IWDG) and 46.6 (RTC).
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Protocol

from .agenda import UNITS, Agenda
from .clocks import LSI

IWDG, RTC = 0x58004800, 0x58004000
KR, PR, RLR, SR, WINR = 0x00, 0x04, 0x08, 0x0C, 0x10
START, OPEN, FEED = 0xCCCC, 0x5555, 0xAAAA
UPDATE_BITS = {PR: 1, RLR: 2, WINR: 4}
UPDATE_CLOCKS = 6
LARGEST = 0xFFF
BACKUP = 0x50


class Surroundings(Protocol):
    """What the watchdog needs of the machine."""

    agenda: Agenda

    @property
    def now(self) -> int: ...
    def watchdog_expired(self) -> None: ...


class Watchdog:
    """``on``: it runs, until the next reset."""

    def __init__(self, machine: Surroundings) -> None:
        self.machine = machine
        self.frequency = LSI
        self.reset()

    def reset(self) -> None:
        self.on = self._open = False
        self.feeds = 0
        self._values = {PR: 0, RLR: LARGEST, WINR: LARGEST}
        self._updating: dict[int, int] = {}
        """The times at which registers will have their new value."""
        self._from = 0
        """The time at which the counter was loaded."""
        self.machine.agenda.set(self, None, self._expire)

    def _clock(self) -> int:
        """Units of time in a count."""
        return (UNITS << min(self._values[PR] & 7, 6) + 2) // self.frequency

    def read(self, offset: int) -> int:
        if offset == SR:
            return sum(
                bit for register, bit in UPDATE_BITS.items() if self._updating.get(register, 0) > self.machine.now
            )
        return self._values.get(offset, 0)

    def write(self, offset: int, value: int) -> None:
        if offset == KR:
            self._key(value & 0xFFFF)
        elif offset in UPDATE_BITS and self._open and self._updating.get(offset, 0) <= self.machine.now:
            self._values[offset] = value & (7 if offset == PR else LARGEST)
            self._updating[offset] = self.machine.now + UPDATE_CLOCKS * self._clock()
            if offset == WINR:
                self._load()
            else:
                self._plan()

    def _key(self, key: int) -> None:
        self._open = key == OPEN
        if key == START and not self.on:
            self.on = True
            self._load()
        elif key == FEED and self.on:
            self.feeds += 1
            counter = self._values[RLR] - (self.machine.now - self._from) // self._clock()
            if counter > self._values[WINR]:
                self._expire()
            else:
                self._load()

    def _load(self) -> None:
        self._from = self.machine.now
        self._plan()

    def _plan(self) -> None:
        due = self._from + (self._values[RLR] + 1) * self._clock() if self.on else None
        self.machine.agenda.set(self, due, self._expire)

    def _expire(self) -> None:
        self.machine.watchdog_expired()


class Backup:
    """``clocked()`` and ``writable()``: RTCAPBEN and DBP."""

    def __init__(self, clocked: Callable[[], bool], writable: Callable[[], bool]) -> None:
        self.clocked = clocked
        self.writable = writable
        self.registers: dict[int, int] = {}

    def reset(self) -> None:
        """Only the loss of VBAT, or BDRST, clears the registers."""

    def clear(self) -> None:
        self.registers.clear()

    def read(self, offset: int) -> int:
        return self.registers.get(offset, 0) if self.clocked() else 0

    def write(self, offset: int, value: int) -> None:
        if self.clocked() and self.writable():
            self.registers[offset] = value

    def __getitem__(self, number: int) -> int:
        """Backup register ``number``."""
        return self.registers.get(BACKUP + 4 * number, 0)
