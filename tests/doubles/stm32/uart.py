# SPDX-License-Identifier: Apache-2.0
"""USARTs of an STM32H743, and the wire at each one (RM0433, 48.8).

A byte takes the time of ten bits.  A wire has its own baud rate: bytes that arrive at another one are not understood.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

from .agenda import UNITS, Agenda

CR1, CR2, CR3, BRR, RQR, ISR, ICR, RDR, TDR, PRESC = 0x00, 0x04, 0x08, 0x0C, 0x18, 0x1C, 0x20, 0x24, 0x28, 0x2C
UE, RE, TE, IDLEIE, RXNEIE, TCIE, TXEIE, OVER8, FIFOEN = 1, 4, 8, 1 << 4, 1 << 5, 1 << 6, 1 << 7, 1 << 15, 1 << 29
EIE, DMAR, DMAT, OVRDIS, DDRE = 1, 1 << 6, 1 << 7, 1 << 12, 1 << 13
FRAMING, NOISE, OVERRUN, IDLE, RXNE, TC, TXE, BUSY = 2, 4, 8, 16, 32, 64, 128, 1 << 16
TEACK, REACK = 1 << 21, 1 << 22
PRESCALERS = (1, 2, 4, 6, 8, 10, 12, 16, 32, 64, 128, 256)
BITS = 10
TOLERANCE = 0.03
"""Relative difference of two baud rates at which bytes still arrive."""


@dataclass(frozen=True)
class Kind:
    base: int
    apb: int
    bit: int
    interrupt: int
    requests: tuple[int, int]
    """DMAMUX1's numbers of the requests to receive and to transmit (RM0433, 17.3.2)."""


KINDS = {
    1: Kind(0x40011000, 2, 4, 37, (41, 42)),
    2: Kind(0x40004400, 1, 17, 38, (43, 44)),
    3: Kind(0x40004800, 1, 18, 39, (45, 46)),
    4: Kind(0x40004C00, 1, 19, 52, (63, 64)),
    5: Kind(0x40005000, 1, 20, 53, (65, 66)),
    6: Kind(0x40011400, 2, 5, 71, (71, 72)),
    7: Kind(0x40007800, 1, 30, 82, (79, 80)),
    8: Kind(0x40007C00, 1, 31, 83, (81, 82)),
}


class Surroundings(Protocol):
    """What a UART needs of the machine."""

    agenda: Agenda

    @property
    def now(self) -> int: ...
    def uart_clock(self, apb: int) -> int: ...
    def line(self, interrupt: int, source: object, high: bool) -> None: ...
    def request(self, number: int) -> None: ...


class Line:
    """The other end of a UART's wires."""

    def __init__(self, uart: Uart) -> None:
        self._uart = uart
        self.baud: int | None = None
        """The baud rate of the other end; None: always that of the UART."""
        self.sent: deque[int] = deque()
        """Bytes that have not yet arrived at the UART."""
        self.received = bytearray()
        """Bytes from the UART."""
        self.on_byte: Callable[[int], None] = lambda byte: None

    def send(self, data: bytes) -> None:
        """Sends bytes to the UART, without a gap, after those that are on the way."""
        self.sent.extend(data)
        self._uart.arriving()

    def take(self) -> bytes:
        """The bytes that were received since the last call."""
        data = bytes(self.received)
        self.received.clear()
        return data


class Uart:
    def __init__(self, number: int, machine: Surroundings) -> None:
        self.number = number
        self.kind = KINDS[number]
        self.machine = machine
        self.line = Line(self)
        self.clocked = False
        self.connected: Callable[[], bool] = lambda: True
        """True if the pins have the UART's function."""
        self.registers: dict[int, int] = {}
        self.reset()

    def reset(self) -> None:
        self.registers = {}
        self.flags = TXE | TC
        self.to_send: deque[int] = deque()
        self.shifting: int | None = None
        self.arrived: deque[int] = deque()
        self.on_wire: int | None = None
        for key in ("tx", "rx", "idle"):
            self.machine.agenda.set((self, key), None, self._idle)
        self._request()

    def _get(self, register: int) -> int:
        return self.registers.get(register, 0)

    @property
    def _depth(self) -> int:
        return 16 if self._get(CR1) & FIFOEN else 1

    @property
    def baud(self) -> float:
        """0 if the UART is off."""
        divider = self._get(BRR)
        clock = self.machine.uart_clock(self.kind.apb) / PRESCALERS[min(self._get(PRESC) & 0xF, 11)]
        if not (self.clocked and self._get(CR1) & UE and divider >= 16):
            return 0.0
        if self._get(CR1) & OVER8:
            return 2 * clock / (divider & 0xFFF0 | (divider & 7) << 1)
        return clock / divider

    def _byte_time(self, baud: float) -> int:
        return round(BITS * UNITS / baud)

    # Registers --------------------------------------------------------------------------------------------------------

    def read(self, register: int) -> int:
        if not self.clocked:
            return 0
        if register == ISR:
            enabled = self._get(CR1) & UE != 0
            ready = (TEACK if enabled and self._get(CR1) & TE else 0) | (
                REACK if enabled and self._get(CR1) & RE else 0
            )
            return self._status() | ready | (BUSY if self.on_wire is not None else 0)
        if register == RDR:
            value = self.arrived.popleft() if self.arrived else 0
            self._request()
            return value
        return self._get(register)

    def _status(self) -> int:
        value = self.flags & ~(RXNE | TXE)
        value |= RXNE if self.arrived else 0
        return value | (TXE if len(self.to_send) < self._depth else 0)

    def write(self, register: int, value: int) -> None:
        if not self.clocked:
            return
        if register == TDR:
            self._transmit(value & 0xFF)
        elif register == ICR:
            self.flags &= ~(value & (FRAMING | NOISE | OVERRUN | IDLE | TC | 1))
        elif register == RQR:
            if value & 8:
                self.arrived.clear()
            if value & 16:
                self.to_send.clear()
        elif register != ISR:
            self.registers[register] = value
            if register in (CR1, CR3):
                if not self._get(CR1) & UE:
                    self.flags = TXE | TC
                    self.arrived.clear()
                    self.to_send.clear()
                self.arriving()
                self.want_data()
                self.offer_data()
        self._request()

    # Transmission -----------------------------------------------------------------------------------------------------

    def _transmit(self, byte: int) -> None:
        if not self._get(CR1) & TE or not self._get(CR1) & UE:
            return
        self.flags &= ~TC
        if len(self.to_send) >= self._depth:
            self.to_send.pop()  # overwritten
        self.to_send.append(byte)
        if self.shifting is None:
            self._shift()

    def _shift(self) -> None:
        self.shifting = self.to_send.popleft() if self.to_send else None
        if self.shifting is None:
            self.flags |= TC
        else:
            self.machine.agenda.set((self, "tx"), self.machine.now + self._byte_time(self.baud), self._shifted)
        self.want_data()

    def _shifted(self) -> None:
        assert self.shifting is not None
        if self.connected() and self._same_baud():
            self.line.received.append(self.shifting)
            self.line.on_byte(self.shifting)
        self._shift()
        self._request()

    def want_data(self) -> None:
        """Requests data by DMA as long as there is room."""
        while self._get(CR3) & DMAT and self._get(CR1) & TE and len(self.to_send) < self._depth:
            before = len(self.to_send), self.shifting
            self.machine.request(self.kind.requests[1])
            if (len(self.to_send), self.shifting) == before:
                return

    def _same_baud(self) -> bool:
        own, other = self.baud, self.line.baud or self.baud
        return own > 0 and abs(own - other) <= TOLERANCE * own

    # Reception --------------------------------------------------------------------------------------------------------

    def arriving(self) -> None:
        """Begins with the next byte of the wire."""
        if self.on_wire is None and self.line.sent and self.baud > 0:
            self.on_wire = self.line.sent.popleft()
            self.machine.agenda.set((self, "idle"), None, self._idle)
            time = self._byte_time(self.line.baud or self.baud)
            self.machine.agenda.set((self, "rx"), self.machine.now + time, self._arrive)

    def _arrive(self) -> None:
        byte, self.on_wire = self.on_wire, None
        assert byte is not None
        if self.baud > 0 and self._get(CR1) & RE and self.connected():
            if self._same_baud():
                self._keep(byte)
            else:
                self.flags |= FRAMING
                # Without DDRE, DMA gets no request for a byte with an error, and RXNE stays 0.
                if self._get(CR3) & (DMAR | DDRE) != DMAR:
                    self._keep(~byte & 0xFF)
            if not self.line.sent:
                self.machine.agenda.set(
                    (self, "idle"), self.machine.now + self._byte_time(self.baud), self._idle
                )  # fmt: skip
        self.arriving()
        self._request()

    def _keep(self, byte: int) -> None:
        if len(self.arrived) < self._depth:
            self.arrived.append(byte)
        elif not self._get(CR3) & OVRDIS:
            self.flags |= OVERRUN
        else:
            self.arrived[-1] = byte
        if self._get(CR3) & DMAR:
            self.machine.request(self.kind.requests[0])

    def _idle(self) -> None:
        self.flags |= IDLE
        self._request()

    def offer_data(self) -> None:
        """Requests that DMA takes what has arrived."""
        while self._get(CR3) & DMAR and self.arrived:
            before = len(self.arrived)
            self.machine.request(self.kind.requests[0])
            if len(self.arrived) == before:
                return

    # Interrupt --------------------------------------------------------------------------------------------------------

    def _request(self) -> None:
        control, status = self._get(CR1), self._status()
        high = bool(status & control & (IDLE | RXNE | TC | TXE))
        high |= bool(control & RXNEIE and status & OVERRUN)
        high |= bool(self._get(CR3) & EIE and status & (FRAMING | NOISE | OVERRUN))
        self.machine.line(self.kind.interrupt, self, high and bool(control & UE))
