# SPDX-License-Identifier: Apache-2.0
"""Exceptions of Armv7-M by their numbers: pending, active, priorities, and the level of interrupt lines.

Source: Armv7-M Architecture Reference Manual (DDI 0403E), B1.5 and B3.4.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

RESET, NMI, HARD_FAULT, MEM_MANAGE, BUS_FAULT, USAGE_FAULT, SVCALL, DEBUG_MONITOR, PENDSV, SYSTICK = (
    1, 2, 3, 4, 5, 6, 11, 12, 14, 15,
)  # fmt: skip
FIRST = 16
"""The exception number of interrupt 0."""
PRIORITY_BITS = 0xF0
"""The chip's four bits of priority."""
ALWAYS_ENABLED = 1 << NMI | 1 << HARD_FAULT | 1 << SVCALL | 1 << PENDSV | 1 << SYSTICK
LOWEST = 256


def bits(mask: int) -> Iterator[int]:
    """The numbers of the bits that are set."""
    while mask:
        low = mask & -mask
        yield low.bit_length() - 1
        mask ^= low


class Nvic:
    """``masks()`` returns PRIMASK, FAULTMASK and BASEPRI; ``changed()`` is called when an exception may be due."""

    def __init__(self, masks: Callable[[], tuple[int, int, int]], changed: Callable[[], None]) -> None:
        self.masks = masks
        self.changed = changed
        self.sources: dict[int, set[Any]] = {}
        """The sources that hold the line of an interrupt high, by exception number."""
        self.reset()

    def reset(self) -> None:
        self.pending = self.active = 0
        self.enabled = ALWAYS_ENABLED
        self.priorities = [0] * LOWEST
        self.priorities[RESET], self.priorities[NMI], self.priorities[HARD_FAULT] = -3, -2, -1
        self.group_bits = 0xFE
        """The bits of a priority that decide about preemption, by PRIGROUP."""
        self.sources.clear()
        self.entered: dict[int, int] = {}
        """How often each exception was entered."""

    # Lines ------------------------------------------------------------------------------------------------------------

    def line(self, interrupt: int, source: object, high: bool) -> None:
        """A peripheral's request for an interrupt; several peripherals may share it."""
        number = FIRST + interrupt
        sources = self.sources.setdefault(number, set())
        if not high:
            sources.discard(source)
        elif source not in sources:
            rises = not sources
            sources.add(source)
            if rises or not self.active >> number & 1:
                self.pend(number)

    def pend(self, number: int) -> None:
        self.pending |= 1 << number
        if self.pending & self.enabled:
            self.changed()

    def clear(self, number: int) -> None:
        self.pending &= ~(1 << number)
        if self.sources.get(number) and not self.active >> number & 1:
            self.pending |= 1 << number

    # Priorities -------------------------------------------------------------------------------------------------------

    def group(self, number: int) -> int:
        priority = self.priorities[number]
        return priority if priority < 0 else priority & self.group_bits

    def running(self, *, without_primask: bool = False) -> int:
        """The execution priority (B1.5.4)."""
        lowest = min((self.group(number) for number in bits(self.active)), default=LOWEST)
        primask, faultmask, basepri = self.masks()
        basepri &= PRIORITY_BITS
        if basepri:
            lowest = min(lowest, basepri & self.group_bits)
        if primask and not without_primask:
            lowest = min(lowest, 0)
        if faultmask:
            lowest = min(lowest, -1)
        return lowest

    def due(self, *, without_primask: bool = False) -> int | None:
        """The pending exception that preempts what runs, or None."""
        candidates = self.pending & self.enabled
        if not candidates:
            return None
        number = min(bits(candidates), key=lambda number: (self.priorities[number], number))
        return number if self.group(number) < self.running(without_primask=without_primask) else None

    # Entry and return -------------------------------------------------------------------------------------------------

    def enter(self, number: int) -> None:
        self.pending &= ~(1 << number)
        self.active |= 1 << number
        self.entered[number] = self.entered.get(number, 0) + 1

    def leave(self, number: int) -> None:
        self.active &= ~(1 << number)
        if self.sources.get(number):
            self.pending |= 1 << number
