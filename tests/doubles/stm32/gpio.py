# SPDX-License-Identifier: Apache-2.0
"""Ports of pins: modes, levels, and a log of the levels that a program drives (RM0433, 11.4)."""

from __future__ import annotations

from collections.abc import Callable

MODER, OTYPER, IDR, ODR, BSRR, AFRL, AFRH = 0x00, 0x04, 0x10, 0x14, 0x18, 0x20, 0x24
INPUT, OUTPUT, ALTERNATE, ANALOG = range(4)
MODES_AT_RESET = {"A": 0xABFFFFFF, "B": 0xFFFFFEBF}


class Port:
    """``changed(pin, level)`` is called when the level of an output changes; level None: the pin is no output."""

    def __init__(self, name: str, changed: Callable[[int, int | None], None]) -> None:
        self.name = name
        self.changed = changed
        self.inputs = 0
        """Levels that other parts drive."""
        self.registers: dict[int, int] = {}
        self.driven: list[int | None] = [None] * 16
        self.clocked = False
        self.reset()

    def reset(self) -> None:
        self.registers = {MODER: MODES_AT_RESET.get(self.name, 0xFFFFFFFF), ODR: 0}
        self._update()

    def mode(self, pin: int) -> int:
        return self.registers[MODER] >> 2 * pin & 3

    def function(self, pin: int) -> int | None:
        """The alternate function of a pin; None if it has another mode."""
        if self.mode(pin) != ALTERNATE:
            return None
        return self.registers.get(AFRL + 4 * (pin // 8), 0) >> 4 * (pin % 8) & 0xF

    def read(self, offset: int) -> int:
        if offset == IDR:
            outputs = sum(1 << pin for pin in range(16) if self.mode(pin) == OUTPUT)
            return self.registers[ODR] & outputs | self.inputs & ~outputs & 0xFFFF
        return 0 if offset == BSRR else self.registers.get(offset, 0)

    def write(self, offset: int, value: int) -> None:
        if offset == BSRR:  # set has priority over reset
            self.registers[ODR] = self.registers[ODR] & ~(value >> 16) | value & 0xFFFF
        elif offset != IDR:
            self.registers[offset] = value & 0xFFFF if offset == ODR else value
        if offset in (MODER, ODR, BSRR):
            self._update()

    def _update(self) -> None:
        for pin in range(16):
            level = self.registers[ODR] >> pin & 1 if self.mode(pin) == OUTPUT else None
            if level != self.driven[pin]:
                self.driven[pin] = level
                self.changed(pin, level)
