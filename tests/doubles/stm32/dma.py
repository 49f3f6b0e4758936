# SPDX-License-Identifier: Apache-2.0
"""The controllers DMA1 and DMA2 with the multiplexer of their requests, DMAMUX1 (RM0433, 15 and 17).

An item is moved at once when a peripheral asks for it.  A transfer from memory to memory takes one clock of the bus per
item.  The FIFO has no model: items have the same size at both sides.  Double buffers, flow control by the peripheral,
and synchronization of requests raise an error when a program chooses them.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

from .agenda import UNITS, Agenda
from .cache import Cache

BASES, MUX, STREAMS = (0x40020000, 0x40020400), 0x40020800, 8
INTERRUPTS = (11, 12, 13, 14, 15, 16, 17, 47, 56, 57, 58, 59, 60, 68, 69, 70)
SHIFTS = (0, 6, 16, 22)
LIFCR, FIRST, EACH = 0x08, 0x10, 0x18
CR, NDTR, PAR, M0AR, M1AR, FCR = range(6)
AT_RESET = (0, 0, 0, 0, 0, 0x21)
EN, CIRCULAR, PERIPHERAL_STEPS, MEMORY_STEPS = 1, 1 << 8, 1 << 9, 1 << 10
TO_MEMORY, FROM_MEMORY, BETWEEN_MEMORIES = range(3)
WITHOUT_MODEL = 1 << 5 | 1 << 18
"""PFCTRL and DBM of CR."""
ERROR, HALF, COMPLETE = 1 << 3, 1 << 4, 1 << 5
PERIPHERALS, FLASH = (0x40000000, 0x60000000), (0x08000000, 0x08200000)
RAM = ((0x24000000, 0x24080000), (0x30000000, 0x30048000), (0x38000000, 0x38010000), (0x38800000, 0x38801000))
"""The memories that both controllers reach; the memories at the core are not among them (RM0433, 2.1.1)."""


class Surroundings(Protocol):
    """What a controller needs of the machine."""

    agenda: Agenda
    cache: Cache

    @property
    def now(self) -> int: ...
    @property
    def bus_clock(self) -> int: ...
    def line(self, interrupt: int, source: object, high: bool) -> None: ...
    def read_flash(self, address: int, size: int) -> bytes: ...
    def read_register(self, address: int, size: int) -> int: ...
    def write_register(self, address: int, value: int, size: int) -> None: ...
    def ask_for_requests(self) -> None: ...


class Unreachable(Exception):
    """The bus has answered with an error."""


@dataclass
class Stream:
    interrupt: int
    registers: list[int]
    flags: int = 0
    reload: int = 0
    """NDTR when the stream was enabled."""

    @property
    def on(self) -> bool:
        return bool(self.registers[CR] & EN)

    @property
    def direction(self) -> int:
        return self.registers[CR] >> 6 & 3


class Dma:
    """Both controllers.  ``errors``: the addresses at which a transfer has failed."""

    def __init__(self, machine: Surroundings) -> None:
        self.machine = machine
        self.clocked = [False, False]
        self.errors: list[int] = []
        self.streams = [Stream(interrupt, list(AT_RESET)) for interrupt in INTERRUPTS]
        self.mux = [0] * len(self.streams)
        """The request that each stream gets; 0: none."""

    def reset(self, number: int) -> None:
        for stream in self.streams[STREAMS * number : STREAMS * (number + 1)]:
            stream.registers = list(AT_RESET)
            stream.flags = stream.reload = 0
            self.machine.agenda.set((self, stream.interrupt), None, lambda: None)
            self._update(stream)

    # Registers --------------------------------------------------------------------------------------------------------

    def read(self, controller: int, offset: int) -> int:
        streams = self.streams[STREAMS * controller : STREAMS * (controller + 1)]
        if not self.clocked[controller]:
            return 0
        if offset < LIFCR:
            return sum(streams[offset + n].flags << shift for n, shift in enumerate(SHIFTS))
        if FIRST <= offset < FIRST + STREAMS * EACH:
            return streams[(offset - FIRST) // EACH].registers[(offset - FIRST) % EACH // 4]
        return 0

    def write(self, controller: int, offset: int, value: int) -> None:
        streams = self.streams[STREAMS * controller : STREAMS * (controller + 1)]
        if not self.clocked[controller]:
            return
        if LIFCR <= offset < FIRST:
            for n, shift in enumerate(SHIFTS):
                stream = streams[offset - LIFCR + n]
                stream.flags &= ~(value >> shift)
                self._update(stream)
        elif FIRST <= offset < FIRST + STREAMS * EACH:
            self._write(streams[(offset - FIRST) // EACH], (offset - FIRST) % EACH // 4, value)

    def _write(self, stream: Stream, register: int, value: int) -> None:
        was_on = stream.on
        if register != CR:
            if not was_on or register == M1AR:  # an enabled stream protects its registers
                stream.registers[register] = value & 0xFFFF if register == NDTR else value
            return
        stream.registers[CR] = value if not was_on else stream.registers[CR] & ~0x1F | value & 0x1F
        if stream.on and not was_on:
            assert not stream.flags, f"a stream is enabled with flags {stream.flags:#x} set (RM0433, 15.3.19)"
            assert not value & WITHOUT_MODEL, f"DMA has no model of this mode: CR {value:#x}"
            assert value >> 11 & 3 == value >> 13 & 3, "DMA has no model of two sizes of items"
            stream.reload = stream.registers[NDTR]
            if not stream.reload:
                stream.registers[CR] &= ~EN
            elif stream.direction == BETWEEN_MEMORIES:
                due = self.machine.now + stream.reload * UNITS // self.machine.bus_clock
                self.machine.agenda.set((self, stream.interrupt), due, lambda: self._move_all(stream))
            else:
                self.machine.ask_for_requests()
        elif was_on and not stream.on:
            stream.flags |= COMPLETE  # RM0433, 15.3.16: the end of a suspended transfer
            self.machine.agenda.set((self, stream.interrupt), None, lambda: None)
        self._update(stream)

    def read_mux(self, offset: int) -> int:
        return self.mux[offset // 4] if offset < 4 * len(self.mux) else 0

    def write_mux(self, offset: int, value: int) -> None:
        if offset < 4 * len(self.mux):
            assert value >> 7 == 0, f"DMAMUX1 has no model of this mode: {value:#x}"
            self.mux[offset // 4] = value
            self.machine.ask_for_requests()

    # Transfers --------------------------------------------------------------------------------------------------------

    def request(self, number: int) -> None:
        """A peripheral asks for one item."""
        for index, stream in enumerate(self.streams):
            if self.mux[index] == number and stream.on and self.clocked[index // STREAMS]:
                self._move(stream)

    def _move_all(self, stream: Stream) -> None:
        while stream.on:
            self._move(stream)

    def _move(self, stream: Stream) -> None:
        """Counts first: the access to the peripheral can make it ask for the next item at once."""
        control, left = stream.registers[CR], stream.registers[NDTR]
        size = 1 << (control >> 11 & 3)
        done = (stream.reload - left) * size
        peripheral = stream.registers[PAR] + (done if control & PERIPHERAL_STEPS else 0)
        memory = stream.registers[M0AR] + (done if control & MEMORY_STEPS else 0)
        source, target = (memory, peripheral) if stream.direction == FROM_MEMORY else (peripheral, memory)
        stream.registers[NDTR] = left - 1
        try:
            data = self._get(source, size)
            if left - 1 == stream.reload // 2:
                stream.flags |= HALF
            if left == 1:
                stream.flags |= COMPLETE
                if control & CIRCULAR:
                    stream.registers[NDTR] = stream.reload
                else:
                    stream.registers[CR] &= ~EN
            self._put(target, data)
        except Unreachable as error:
            self.errors.append(int(error.args[0]))
            stream.flags = stream.flags & ~(HALF | COMPLETE) | ERROR
            stream.registers[CR] &= ~EN
        self._update(stream)

    def _get(self, address: int, size: int) -> bytes:
        if PERIPHERALS[0] <= address < PERIPHERALS[1]:
            return self.machine.read_register(address, size).to_bytes(size, "little")
        if FLASH[0] <= address < FLASH[1]:
            return self.machine.read_flash(address, size)
        self._check(address, size)
        return self.machine.cache.dma_read(address, size)

    def _put(self, address: int, data: bytes) -> None:
        if PERIPHERALS[0] <= address < PERIPHERALS[1]:
            self.machine.write_register(address, int.from_bytes(data, "little"), len(data))
            return
        self._check(address, len(data))
        self.machine.cache.dma_write(address, data)

    def _check(self, address: int, size: int) -> None:
        assert address % size == 0, f"DMA has no model of items that are not aligned: {address:#x}"
        if not any(begin <= address < end for begin, end in RAM):
            raise Unreachable(address)

    def _update(self, stream: Stream) -> None:
        """The interrupt: TCIE, HTIE and TEIE of CR are one bit below their flags."""
        high = bool(stream.registers[CR] << 1 & stream.flags & (ERROR | HALF | COMPLETE))
        self.machine.line(stream.interrupt, self, high)


class Block:
    """The registers of one controller."""

    def __init__(self, dma: Dma, number: int) -> None:
        self.dma = dma
        self.number = number

    @property
    def clocked(self) -> bool:
        return self.dma.clocked[self.number]

    @clocked.setter
    def clocked(self, value: bool) -> None:
        self.dma.clocked[self.number] = value

    def reset(self) -> None:
        self.dma.reset(self.number)

    def read(self, offset: int) -> int:
        return self.dma.read(self.number, offset)

    def write(self, offset: int, value: int) -> None:
        self.dma.write(self.number, offset, value)


class Multiplexer:
    """DMAMUX1."""

    def __init__(self, dma: Dma) -> None:
        self.dma = dma

    def reset(self) -> None:
        self.dma.mux = [0] * len(self.dma.streams)

    def read(self, offset: int) -> int:
        return self.dma.read_mux(offset)

    def write(self, offset: int, value: int) -> None:
        self.dma.write_mux(offset, value)
