# SPDX-License-Identifier: Apache-2.0
"""The USB device OTG_FS of an STM32H743, without DMA: registers, FIFOs, endpoints, and what it does on the bus.

``usb_host.py`` is at the other end of the cable.  The host detects the device only if its supply, its clock, its pins
and its transceiver are on.  There are no errors on the wire, so data toggles have no model.

Source: RM0433, 57 (OTG), in slave mode; the ids of the core are those of real chips.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Protocol

from .agenda import UNITS

BASE, INTERRUPT = 0x40080000, 101
ENDPOINTS = 9
WORDS = 1024
"""The memory of all FIFOs, in words of 32 bits."""
GOTGCTL, GOTGINT, GAHBCFG, GUSBCFG, GRSTCTL, GINTSTS, GINTMSK = 0x00, 0x04, 0x08, 0x0C, 0x10, 0x14, 0x18
GRXSTSR, GRXSTSP, GRXFSIZ, DIEPTXF0, GCCFG, DIEPTXF = 0x1C, 0x20, 0x24, 0x28, 0x38, 0x100
DCFG, DCTL, DSTS, DIEPMSK, DOEPMSK, DAINT, DAINTMSK, DIEPEMPMSK = 0x800, 0x804, 0x808, 0x810, 0x814, 0x818, 0x81C, 0x834
IN_ENDPOINTS, OUT_ENDPOINTS, FIFOS = 0x900, 0xB00, 0x1000
CTL, INT, TSIZ, SPACE = 0x00, 0x08, 0x10, 0x18
IDS = {0x3C: 0x2300, 0x40: 0x4F54330A, 0x44: 0, 0x48: 0x229FE190, 0x4C: 0x03B8D2E8, 0x50: 0xE3F00030}
AT_RESET = {GUSBCFG: 0x1440, GRXFSIZ: 0x400, DIEPTXF0: 0x02000400, DCTL: 2, DCFG: 0x02200000}
SOF, RXFLVL, GONAKEFF, SUSPEND, BUS_RESET, ENUMERATED, IEPINT, OEPINT, WAKEUP = (
    1 << 3, 1 << 4, 1 << 7, 1 << 11, 1 << 12, 1 << 13, 1 << 18, 1 << 19, 1 << 31,
)  # fmt: skip
LATCHED = SOF | SUSPEND | BUS_RESET | ENUMERATED | WAKEUP
DONE, DISABLED, SETUP, NAK_EFFECTIVE, EMPTY = 1, 2, 8, 1 << 6, 1 << 7
ACTIVE, NAKED, STALL, CLEAR_NAK, SET_NAK, DISABLE, ENABLE = (
    1 << 15,
    1 << 17,
    1 << 21,
    1 << 26,
    1 << 27,
    1 << 30,
    1 << 31,
)
COMMANDS = CLEAR_NAK | SET_NAK | DISABLE | 3 << 28
RX_DATA, RX_DONE, RX_SETUP_DONE, RX_SETUP = 2, 3, 4, 6
STALLED = "stalled"


class Surroundings(Protocol):
    """What the device needs of the machine."""

    @property
    def now(self) -> int: ...
    def line(self, interrupt: int, source: object, high: bool) -> None: ...


@dataclass
class Endpoint:
    """One direction of an endpoint.  ``packets``: of an IN endpoint, those that wait in its FIFO."""

    number: int
    control: int = 0
    size: int = 0
    flags: int = 0
    packets: deque[bytes] = field(default_factory=deque)
    partial: bytearray = field(default_factory=bytearray)

    @property
    def largest(self) -> int:
        return (64, 32, 16, 8)[self.control & 3] if self.number == 0 else self.control & 0x7FF

    @property
    def ready(self) -> bool:
        return bool(self.control & ENABLE) and not self.control & NAKED

    @property
    def left(self) -> int:
        """Bytes of the transfer."""
        return self.size & (0x7F if self.number == 0 else 0x7FFFF)

    @property
    def count(self) -> int:
        """Packets of the transfer."""
        return self.size >> 19 & (3 if self.number == 0 else 0x3FF)

    def take(self, length: int) -> None:
        self.size -= min(length, self.left)

    def packet(self) -> None:
        self.size -= 1 << 19 if self.count else 0

    @property
    def words(self) -> int:
        return sum((len(packet) + 3) // 4 for packet in self.packets) + (len(self.partial) + 3) // 4

    def flush(self) -> None:
        self.packets.clear()
        self.partial.clear()

    def end(self) -> None:
        self.control = self.control & ~ENABLE | NAKED
        self.flags |= DONE


class Usb:
    """``clocked``: by RCC; ``powered()``: supply, 48 MHz and pins."""

    def __init__(self, machine: Surroundings, powered: Callable[[], bool]) -> None:
        self.machine = machine
        self.interrupt = INTERRUPT
        self.powered = powered
        self.clocked = False
        self.changed: Callable[[], None] = lambda: None
        """Called when the device may answer the host in another way than before."""
        self.overflows = 0
        """Words that were written to a FIFO without room, or read from an empty one."""
        self.reset()

    def reset(self) -> None:
        self.registers = dict(AT_RESET)
        self.status = 0
        self.ins = [Endpoint(number) for number in range(ENDPOINTS)]
        self.outs = [Endpoint(number) for number in range(ENDPOINTS)]
        self.ins[0].control = self.outs[0].control = ACTIVE
        self.received: deque[tuple[int, int, list[int]]] = deque()
        """The receive FIFO: kind, endpoint, and the words of each entry."""
        self.reading: deque[int] = deque()
        self.lengths: deque[int] = deque()
        self.address = 0
        self.suspended = False
        self._update()
        self.changed()

    @property
    def present(self) -> bool:
        """The pull-up on D+, by which the host detects a device."""
        control, session = self.registers, self.registers.get(GOTGCTL, 0)
        return bool(
            self.clocked and self.powered()
            and control.get(GCCFG, 0) & 1 << 16  # the transceiver
            and control[GUSBCFG] & 1 << 30 and session & 0xC0 == 0xC0  # device, whose session is valid without VBUS
            and not control[DCTL] & 2 and control[DCFG] & 3 == 3
        )  # fmt: skip

    # Registers ----------------------------------------------------------------------------------------------------

    def read(self, offset: int) -> int:
        if not self.clocked:
            return 0
        if offset >= FIFOS:
            return self._pop()
        if IN_ENDPOINTS <= offset < OUT_ENDPOINTS + 0x20 * ENDPOINTS:
            return self._read_endpoint(offset)
        if offset in (GRXSTSP, GRXSTSR):
            return self._pop_status() if offset == GRXSTSP else 0
        computed = {
            GRSTCTL: lambda: 1 << 31,
            GINTSTS: lambda: self._interrupts(),
            DSTS: lambda: self._frame() << 8 | 6 | self.suspended,
            DAINT: lambda: self._pending(),
        }
        if offset in computed:
            return computed[offset]()
        return IDS.get(offset, self.registers.get(offset, 0))

    def write(self, offset: int, value: int) -> None:
        if not self.clocked:
            return
        if offset >= FIFOS:
            self._push((offset - FIFOS) >> 12, value)
        elif IN_ENDPOINTS <= offset < OUT_ENDPOINTS + 0x20 * ENDPOINTS:
            self._write_endpoint(offset, value)
        elif offset == GINTSTS:
            self.status &= ~(value & LATCHED)
        elif offset == GRSTCTL:
            self._command(value)
        elif offset == DCTL:
            nak = self.registers[DCTL] & 8
            nak = 8 if value & 1 << 9 else 0 if value & 1 << 10 else nak
            self.registers[DCTL] = value & ~(0xF << 7) & ~8 | nak
            self.changed()
        elif offset not in IDS:
            self.registers[offset] = value
            self.changed()
        self._update()

    def _command(self, value: int) -> None:
        if value & 1:  # core soft reset; the registers outside of the core keep their values
            kept = {name: self.registers[name] for name in (GCCFG, GUSBCFG, GOTGCTL) if name in self.registers}
            self.reset()
            self.registers |= kept
        if value & 1 << 4:
            self.received.clear()
            self.reading.clear()
        if value & 1 << 5:
            number = value >> 6 & 0x1F
            for endpoint in self.ins:
                if number in (0x10, endpoint.number):
                    endpoint.flush()

    def _endpoint(self, offset: int) -> tuple[Endpoint, int, bool]:
        out = offset >= OUT_ENDPOINTS
        at = offset - (OUT_ENDPOINTS if out else IN_ENDPOINTS)
        return (self.outs if out else self.ins)[at >> 5], at & 0x1F, out

    def _read_endpoint(self, offset: int) -> int:
        if not offset % 0x20 + (offset & ~0x1F) < OUT_ENDPOINTS + 0x20 * ENDPOINTS:
            return 0
        if IN_ENDPOINTS + 0x20 * ENDPOINTS <= offset < OUT_ENDPOINTS:
            return 0
        endpoint, register, out = self._endpoint(offset)
        if register == INT:
            return endpoint.flags | (EMPTY if not out and not endpoint.words else 0)
        if register == SPACE:
            return self._room(endpoint)
        return {CTL: endpoint.control, TSIZ: endpoint.size}.get(register, 0)

    def _room(self, endpoint: Endpoint) -> int:
        register = DIEPTXF0 if endpoint.number == 0 else DIEPTXF + 4 * endpoint.number
        return (self.registers.get(register, 0) >> 16) - endpoint.words

    def _write_endpoint(self, offset: int, value: int) -> None:
        if IN_ENDPOINTS + 0x20 * ENDPOINTS <= offset < OUT_ENDPOINTS:
            return
        endpoint, register, out = self._endpoint(offset)
        if register == INT:
            endpoint.flags &= ~value
        elif register == TSIZ:
            endpoint.size = value
        elif register == CTL:
            self._control(endpoint, value, out)
        self._update()
        self.changed()

    def _control(self, endpoint: Endpoint, value: int, out: bool) -> None:
        kept = endpoint.control & (NAKED | ENABLE | (ACTIVE if endpoint.number == 0 else 0))
        endpoint.control = value & ~(COMMANDS | NAKED | ENABLE) | kept
        if value & CLEAR_NAK:
            endpoint.control &= ~NAKED
        if value & SET_NAK:
            endpoint.control |= NAKED
            endpoint.flags |= 0 if out else NAK_EFFECTIVE
        if value & DISABLE and endpoint.control & ENABLE:
            endpoint.control &= ~ENABLE
            endpoint.flags |= DISABLED
        elif value & ENABLE:
            endpoint.control |= ENABLE
            if not out and endpoint.left == 0 and endpoint.count:
                endpoint.packets.append(b"")

    # FIFOs ----------------------------------------------------------------------------------------------------------

    def _push(self, number: int, word: int) -> None:
        """A word of the next packet that an IN endpoint sends."""
        endpoint = self.ins[number]
        length = min(endpoint.largest, endpoint.left)
        if not endpoint.control & ENABLE or length == 0 or self._room(endpoint) < 1:
            self.overflows += 1
            return
        endpoint.partial += word.to_bytes(4, "little")
        if len(endpoint.partial) >= length:
            endpoint.packets.append(bytes(endpoint.partial[:length]))
            endpoint.partial.clear()
            endpoint.take(length)
            self.changed()

    def _pop_status(self) -> int:
        if not self.received:
            self.overflows += 1
            return 0
        kind, number, words = self.received.popleft()
        self.reading.extend(words)
        length = self.lengths.popleft()
        if kind == RX_SETUP_DONE:
            self.outs[number].flags |= SETUP
        elif kind == RX_DONE:
            self.outs[number].end()
        self._update()
        self.changed()
        return number | length << 4 | kind << 17

    def _pop(self) -> int:
        if not self.reading:
            self.overflows += 1
            return 0
        return self.reading.popleft()

    def _receive(self, kind: int, number: int, data: bytes = b"") -> None:
        words = [int.from_bytes(data[at : at + 4], "little") for at in range(0, len(data), 4)]
        self.received.append((kind, number, words))
        self.lengths.append(len(data))
        self._update()

    @property
    def _used(self) -> int:
        return sum(1 + len(words) for _, _, words in self.received) + len(self.reading)

    def _fits(self, length: int) -> bool:
        """Room for a packet with its status, and for the status of its end."""
        return self._used + 2 + (length + 3) // 4 <= self.registers[GRXFSIZ]

    # Interrupts -------------------------------------------------------------------------------------------------------

    def _pending(self) -> int:
        """DAINT."""
        masks, bits = self.registers, 0
        for endpoint in self.ins:
            enabled = masks.get(DIEPMSK, 0)
            enabled |= EMPTY if masks.get(DIEPEMPMSK, 0) >> endpoint.number & 1 else 0
            flags = endpoint.flags | (0 if endpoint.words else EMPTY)
            bits |= 1 << endpoint.number if flags & enabled else 0
        for endpoint in self.outs:
            bits |= 1 << 16 + endpoint.number if endpoint.flags & masks.get(DOEPMSK, 0) else 0
        return bits

    def _interrupts(self) -> int:
        """GINTSTS."""
        pending = self._pending() & self.registers.get(DAINTMSK, 0)
        value = self.status | (RXFLVL if self.received else 0)
        value |= GONAKEFF if self.registers[DCTL] & 8 else 0
        return value | (IEPINT if pending & 0xFFFF else 0) | (OEPINT if pending >> 16 else 0)

    def _update(self) -> None:
        enabled = self.registers.get(GINTMSK, 0) if self.registers.get(GAHBCFG, 0) & 1 else 0
        self.machine.line(self.interrupt, self, bool(self._interrupts() & enabled))

    # The bus ----------------------------------------------------------------------------------------------------------

    def _frame(self) -> int:
        return self.machine.now * 1000 // UNITS & 0x3FFF

    def raise_status(self, bits: int) -> None:
        self.status |= bits
        self.suspended = (self.suspended and not bits & (BUS_RESET | WAKEUP)) or bool(bits & SUSPEND)
        self._update()

    def _answers(self, address: int) -> bool:
        return self.present and address == self.address

    def bus_reset(self) -> None:
        self.address = 0
        self.raise_status(BUS_RESET)

    def setup(self, address: int, packet: bytes) -> bool:
        """A setup packet.  It is accepted always; False if the device does not answer."""
        if not self._answers(address) or not self._fits(len(packet)):
            return False
        for endpoint in (self.ins[0], self.outs[0]):
            endpoint.control = endpoint.control & ~STALL | NAKED
        self._receive(RX_SETUP, 0, packet)
        self._receive(RX_SETUP_DONE, 0)
        return True

    def give(self, address: int, number: int, data: bytes) -> bool | str:
        """A packet to an OUT endpoint.  False: NAK."""
        endpoint = self.outs[number]
        if not self._answers(address) or not endpoint.control & ACTIVE:
            return False
        if endpoint.control & STALL:
            return STALLED
        if not endpoint.ready or self.registers[DCTL] & 8 or not self._fits(len(data)):
            return False
        assert len(data) <= endpoint.largest, "babble"
        self._receive(RX_DATA, number, data)
        endpoint.take(len(data))
        endpoint.packet()
        if endpoint.count == 0 or len(data) < endpoint.largest:
            endpoint.control |= NAKED  # until the program has read the end of the transfer
            self._receive(RX_DONE, number)
        return True

    def take(self, address: int, number: int) -> bytes | str | None:
        """A packet from an IN endpoint.  None: NAK."""
        endpoint = self.ins[number]
        if not self._answers(address) or not endpoint.control & ACTIVE:
            return None
        if endpoint.control & STALL:
            return STALLED
        if not endpoint.ready or not endpoint.packets:
            return None
        data = endpoint.packets.popleft()
        endpoint.packet()
        if endpoint.count == 0:
            endpoint.end()
        if number == 0 and not data:  # the status of SET_ADDRESS: from now on the new address is valid
            self.address = self.registers[DCFG] >> 4 & 0x7F
        self._update()
        return data
