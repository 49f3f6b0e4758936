# SPDX-License-Identifier: Apache-2.0
"""The data cache of the core, as DMA sees it: RAM has a second copy, which only maintenance exchanges with the first.

The worst case of a cache is modelled: all lines of cacheable RAM are in it, and none leaves it by itself.  A program
that forgets to clean or to invalidate therefore fails always, not sometimes.  One thing that a real cache does by
chance is reported in its place: ``hazards`` lists the lines into which DMA wrote while the cache had changes of them.
Cleaning such a line, or its leaving the cache, destroys what DMA has written.

Flash is not modelled here.  Turning the cache off writes all changes to memory.

Source: Armv7-M Architecture Reference Manual (DDI 0403E), B3.1 (default map) and B3.5 (MPU); Cortex-M7 TRM (DDI 0489),
5.  Shareable memory is not cached (DDI 0489, 5.2.1, with CACR.SIWT = 0).
"""

from __future__ import annotations

from typing import Any

from .system_control import (
    CCR,
    DCCIMVAC,
    DCCISW,
    DCCMVAC,
    DCCMVAU,
    DCCSW,
    DCIMVAC,
    DCISW,
    MPU_CTRL,
    SystemControl,
)

LINE, SETS = 32, 128
CACHE_ON, MPU_ON, DEFAULT_MAP = 1 << 16, 1, 4
UNCACHED, WRITE_THROUGH, WRITE_BACK = range(3)
CLEANS, INVALIDATES = (DCCMVAU, DCCMVAC, DCCSW, DCCIMVAC, DCCISW), (DCIMVAC, DCISW, DCCIMVAC, DCCISW)
BY_SET = (DCISW, DCCSW, DCCISW)


def policy(attributes: int) -> int:
    """How memory with these TEX, S, C and B of a region is cached (B3.5.5)."""
    tex, shareable, cached, buffered = (
        attributes >> 19 & 7,
        attributes >> 18 & 1,
        attributes >> 17 & 1,
        attributes >> 16 & 1,
    )
    if tex & 4:  # the inner policy
        found = (UNCACHED, WRITE_BACK, WRITE_THROUGH, WRITE_BACK)[cached << 1 | buffered]
    elif tex == 0:
        found = (WRITE_BACK if buffered else WRITE_THROUGH) if cached else UNCACHED
    else:
        found = WRITE_BACK if tex == 1 and cached and buffered else UNCACHED
    return UNCACHED if shareable else found


class Cache:
    """``memories``: base and size of each RAM behind the cache."""

    def __init__(self, cpu: Any, control: SystemControl, memories: tuple[tuple[int, int], ...]) -> None:
        self.cpu = cpu
        self.control = control
        self.memories = memories
        self.hazards: list[int] = []
        self._policies = {base: bytes(size // LINE) for base, size in memories}
        self._memory = {base: bytearray(size) for base, size in memories}
        self._loaded = {base: bytearray(size) for base, size in memories}
        """The contents of each line when it came into the cache; changes are the differences to them."""
        control.on_memory_attributes = self.update
        control.maintain = self.maintain

    # Policies of memory -----------------------------------------------------------------------------------------------

    def update(self) -> None:
        """Reads CCR and the MPU again.  What becomes cacheable comes into the cache."""
        on = self.control.read(CCR) & CACHE_ON
        for base, size in self.memories:
            new = self._find(base, size) if on else bytes(size // LINE)
            old = self._policies[base]
            if new == old:
                continue
            self._policies[base] = new
            data = self.cpu.mem_read(base, size)
            for number, (before, after) in enumerate(zip(old, new)):
                if after and not before:
                    at = slice(number * LINE, (number + 1) * LINE)
                    self._memory[base][at] = self._loaded[base][at] = data[at]

    def _find(self, base: int, size: int) -> bytes:
        control = self.control.read(MPU_CTRL)
        if not control & MPU_ON:
            return bytes([WRITE_BACK]) * (size // LINE)
        found = bytearray([WRITE_BACK if control & DEFAULT_MAP else UNCACHED]) * (size // LINE)
        for _, (address, attributes) in sorted(self.control.regions.items()):
            if not attributes & 1:
                continue
            length = 2 << (attributes >> 1 & 0x1F)
            begin, part = address & ~(length - 1), length // 8
            for number in range(8):
                if attributes >> 8 + number & 1 and part >= LINE:  # this part is not of the region
                    continue
                first = max(0, begin + number * part - base)
                last = min(size, begin + (number + 1) * part - base)
                if first < last:
                    lines = slice(first // LINE, -(-last // LINE))
                    found[lines] = bytes([policy(attributes)]) * (lines.stop - lines.start)
        return bytes(found)

    def _place(self, address: int) -> tuple[int, int] | None:
        """The memory's base and the number of the line, if the address is cached."""
        for base, size in self.memories:
            if base <= address < base + size:
                number = (address - base) // LINE
                return (base, number) if self._policies[base][number] else None
        return None

    # Maintenance ------------------------------------------------------------------------------------------------------

    def maintain(self, register: int, value: int) -> None:
        clean, invalidate = register in CLEANS, register in INVALIDATES
        if register not in BY_SET:
            place = self._place(value)
            if place:
                self._maintain(*place, clean, invalidate)
        elif not value >> 30:  # all lines of a set, with its way 0
            index = value >> 5 & SETS - 1
            for base, size in self.memories:
                for number in range(index, size // LINE, SETS):
                    if self._policies[base][number]:
                        self._maintain(base, number, clean, invalidate)

    def _maintain(self, base: int, number: int, clean: bool, invalidate: bool) -> None:
        at = slice(number * LINE, (number + 1) * LINE)
        if clean:
            data = bytes(self.cpu.mem_read(base + at.start, LINE))
            if data != self._loaded[base][at]:
                self._memory[base][at] = self._loaded[base][at] = data
        if invalidate:
            self._loaded[base][at] = self._memory[base][at]
            self.cpu.mem_write(base + at.start, bytes(self._memory[base][at]))

    def lose(self) -> None:
        """A reset: the cache is off and its changes are lost."""
        for base, size in self.memories:
            for number in range(size // LINE):
                if self._policies[base][number]:
                    self._write_through(base, number)
                    self._maintain(base, number, False, True)
            self._policies[base] = bytes(size // LINE)

    # DMA --------------------------------------------------------------------------------------------------------------

    def _write_through(self, base: int, number: int) -> None:
        """Brings the core's changes of a line with that policy to memory."""
        if self._policies[base][number] != WRITE_THROUGH:
            return
        start = number * LINE
        for n, byte in enumerate(self.cpu.mem_read(base + start, LINE), start):
            if byte != self._loaded[base][n]:
                self._memory[base][n] = self._loaded[base][n] = byte

    def dma_read(self, address: int, size: int) -> bytes:
        """An item, which does not cross a line."""
        place = self._place(address)
        if place is None:
            return bytes(self.cpu.mem_read(address, size))
        self._write_through(*place)
        return bytes(self._memory[place[0]][address - place[0] : address - place[0] + size])

    def dma_write(self, address: int, data: bytes) -> None:
        place = self._place(address)
        if place is None:
            self.cpu.mem_write(address, data)
            return
        base, number = place
        self._write_through(base, number)
        line = slice(number * LINE, (number + 1) * LINE)
        if bytes(self.cpu.mem_read(base + line.start, LINE)) != self._loaded[base][line]:
            self.hazards.append(base + line.start)
        self._memory[base][address - base : address - base + len(data)] = data
