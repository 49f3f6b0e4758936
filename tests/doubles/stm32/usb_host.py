# SPDX-License-Identifier: Apache-2.0
"""A USB host at the connector of an emulated STM32H743: it enumerates the device, and opens its serial ports (CDC ACM).

>>> # host = UsbHost(chip, seed=3)
>>> # chip.run_until(lambda: host.configured)
>>> # host.ports[1].open()
>>> # host.ports[1].send(b"version\\r\\n")
>>> # host.ports[1].take()
>>> # host.unplug()

Each packet takes 45 to 105 us, one in ten up to a frame of 1 ms more.
"""

from __future__ import annotations

import random
from collections import deque
from collections.abc import Generator
from typing import Protocol

from tests.doubles.usb_descriptors import SerialPort, serial_ports, text

from .agenda import UNITS, Agenda
from .usb import ENUMERATED, STALLED, SUSPEND, Usb

DEVICE, CONFIGURATION, STRING = 1, 2, 3
GET_DESCRIPTOR, SET_ADDRESS, SET_CONFIGURATION = 6, 5, 9
SET_LINE_CODING, SET_CONTROL_LINES = 0x20, 0x22
DEBOUNCE, RESET, SUSPENDS, LONGEST = 0.002, 0.010, 0.003, 1.0
"""Seconds: until a device is reset, of the reset, without frames until it is suspended, for an answer."""
ADDRESS = 5
LARGEST = 64

Transaction = tuple[str, int, bytes]
Transfer = Generator[Transaction, bytes, None]


class Machine(Protocol):
    """What the host needs of the machine."""

    agenda: Agenda
    usb: Usb

    @property
    def now(self) -> int: ...


class Terminal:
    """A program that uses a serial port of the device."""

    def __init__(self, host: UsbHost, port: SerialPort) -> None:
        self._host = host
        self.port = port
        self.is_open = False
        self.to_send: deque[bytes] = deque()
        self.received = bytearray()

    def open(self) -> None:
        self._lines(3)

    def close(self) -> None:
        self._lines(0)

    def _lines(self, lines: int) -> None:
        coding = (115200).to_bytes(4, "little") + bytes((0, 0, 8))
        self._host.request(0x21, SET_LINE_CODING, 0, self.port.control, coding)
        self._host.request(0x21, SET_CONTROL_LINES, lines, self.port.control)
        self.is_open = lines != 0
        self._host.look()

    def send(self, data: bytes) -> None:
        self.to_send.extend(data[at : at + LARGEST] for at in range(0, len(data), LARGEST))
        self._host.look()

    def take(self) -> bytes:
        """The bytes that were received since the last call."""
        data = bytes(self.received)
        self.received.clear()
        return data


class UsbHost:
    """``descriptors``: those of the device and of its configuration; ``texts``: by their index."""

    def __init__(self, machine: Machine, *, seed: int = 1, plugged: bool = True) -> None:
        self.machine = machine
        self._chance = random.Random(seed)
        self.plugged = False
        self.stalls = 0
        self.seen = 0
        """How often a device was detected."""
        self._clear()
        machine.usb.changed = self._device_changed
        if plugged:
            self.plug()

    def _clear(self) -> None:
        self.state = "detached"
        self.address = 0
        self.descriptors: dict[int, bytes] = {}
        self.texts: dict[int, str] = {}
        self.ports: list[Terminal] = []
        self._transfers: deque[Transfer] = deque()
        self._next: Transaction | None = None
        self._since = 0
        self._waiting: set[tuple[str, int]] = set()
        for key in ("bus", "control"):
            self.machine.agenda.set((self, key), None, self._device_changed)

    @property
    def configured(self) -> bool:
        return self.state == "configured"

    def _after(self, key: object, seconds: float, action: object) -> None:
        due = self.machine.now + round(seconds * UNITS)
        self.machine.agenda.set((self, key), due, action)  # type: ignore[arg-type]

    def _delay(self) -> float:
        late = 1000 if self._chance.random() < 0.1 else 60
        return (45 + self._chance.random() * late) * 1e-6

    # The cable --------------------------------------------------------------------------------------------------------

    def plug(self) -> None:
        self.plugged = True
        self._device_changed()

    def unplug(self) -> None:
        """The device sees a bus without frames."""
        self.plugged = False
        self._clear()
        self._after("suspend", SUSPENDS, lambda: self.machine.usb.raise_status(SUSPEND))

    def bus_reset(self) -> None:
        self._clear()
        self._reset_bus()

    def _device_changed(self) -> None:
        present = self.plugged and self.machine.usb.present
        if self.state == "detached" and present:
            self.seen += 1
            self.state = "detected"
            self._after("bus", DEBOUNCE, self._reset_bus)
        elif self.state != "detached" and not present:
            self._clear()
        else:
            self.look()

    def _reset_bus(self) -> None:
        self.machine.agenda.set((self, "suspend"), None, self._device_changed)
        self.state = "reset"
        self.machine.usb.bus_reset()
        self._after("bus", RESET, self._reset_ends)

    def _reset_ends(self) -> None:
        self.machine.usb.raise_status(ENUMERATED)
        self.state = "addressed"
        self._after("bus", RESET, self._begin)

    def _begin(self) -> None:
        self._transfers.append(self._enumerate())
        self.look()

    # Enumeration ------------------------------------------------------------------------------------------------------

    def _enumerate(self) -> Transfer:
        yield from self._read(DEVICE, 0, 64, self.descriptors)
        yield from self._control(0, SET_ADDRESS, ADDRESS, 0)
        self.address = ADDRESS
        yield from self._read(DEVICE, 0, 18, self.descriptors)
        yield from self._read(CONFIGURATION, 0, 9, self.descriptors)
        whole = int.from_bytes(self.descriptors[CONFIGURATION][2:4], "little")
        yield from self._read(CONFIGURATION, 0, whole, self.descriptors)
        found = serial_ports(self.descriptors[CONFIGURATION])
        device = self.descriptors[DEVICE]
        for index in [*device[14:17], *(port.text for port in found)]:
            strings: dict[int, bytes] = {}
            yield from self._read(STRING, index, 255, strings)
            self.texts[index] = text(strings[STRING])
        yield from self._control(0, SET_CONFIGURATION, 1, 0)
        self.ports = [Terminal(self, port) for port in found]
        self.state = "configured"

    def _read(self, kind: int, index: int, length: int, into: dict[int, bytes]) -> Transfer:
        language = 0x409 if kind == STRING else 0
        yield ("setup", 0, _setup(0x80, GET_DESCRIPTOR, kind << 8 | index, language, length))
        data = b""
        while len(data) < length:
            packet = yield ("in", 0, b"")
            data += packet
            if len(packet) < LARGEST:
                break
        yield ("out", 0, b"")
        into[kind] = data

    def _control(self, kind: int, code: int, value: int, index: int, data: bytes = b"") -> Transfer:
        yield ("setup", 0, _setup(kind, code, value, index, len(data)))
        for at in range(0, len(data), LARGEST):
            yield ("out", 0, data[at : at + LARGEST])
        status = yield ("in", 0, b"")
        assert status == b"", "the status of a request has no data"

    def request(self, kind: int, code: int, value: int, index: int, data: bytes = b"") -> None:
        """A request to the device, with data from the host."""
        self._transfers.append(self._control(kind, code, value, index, data))
        self.look()

    # Transactions -----------------------------------------------------------------------------------------------------

    def look(self) -> None:
        """Plans a transaction for each endpoint that has something to do."""
        if self.state not in ("addressed", "configured"):
            return
        if self._transfers and ("control", 0) not in self._waiting:
            self._plan("control", 0, self._step)
        for terminal in self.ports:
            if terminal.is_open:
                number = terminal.port.bulk_in & 0xF
                usb = self.machine.usb.ins[number]
                if usb.packets and usb.ready:
                    self._plan("in", number, lambda terminal=terminal: self._poll(terminal))
                if terminal.to_send and self.machine.usb.outs[terminal.port.bulk_out].ready:
                    self._plan("out", terminal.port.bulk_out, lambda terminal=terminal: self._feed(terminal))

    def _plan(self, kind: str, number: int, action: object) -> None:
        key = (kind, number)
        if key in self._waiting:
            return

        def run() -> None:
            if key in self._waiting:
                self._waiting.discard(key)
                action()  # type: ignore[operator]
                self.look()

        self._waiting.add(key)
        self._after(key, self._delay(), run)

    def _poll(self, terminal: Terminal) -> None:
        data = self.machine.usb.take(self.address, terminal.port.bulk_in & 0xF)
        if isinstance(data, bytes):
            terminal.received += data

    def _feed(self, terminal: Terminal) -> None:
        if (
            terminal.to_send
            and self.machine.usb.give(self.address, terminal.port.bulk_out, terminal.to_send[0]) is True
        ):
            terminal.to_send.popleft()

    def _step(self) -> None:
        """A transaction of the control endpoint; the same again after NAK."""
        if not self._transfers:
            return
        transfer = self._transfers[0]
        if self._next is None:
            self._next = next(transfer)
            self._since = self.machine.now
        assert self.machine.now - self._since < LONGEST * UNITS, f"the device does not answer: {self._next}"
        kind, number, data = self._next
        usb = self.machine.usb
        answer: bytes | bool | str | None
        if kind == "setup":
            answer = usb.setup(self.address, data)
        elif kind == "out":
            answer = usb.give(self.address, number, data)
        else:
            answer = usb.take(self.address, number)
        if answer is None or answer is False:
            return
        if answer == STALLED:
            self.stalls += 1
            self._transfers.popleft()
            self._next = None
            return
        self._since = self.machine.now
        try:
            self._next = transfer.send(answer if isinstance(answer, bytes) else b"")
        except StopIteration:
            self._next = None
            self._transfers.popleft()


def _setup(kind: int, code: int, value: int, index: int, length: int) -> bytes:
    return bytes((kind, code)) + b"".join(word.to_bytes(2, "little") for word in (value, index, length))
