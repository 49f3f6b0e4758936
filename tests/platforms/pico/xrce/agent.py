# SPDX-License-Identifier: Apache-2.0
"""The XRCE agent on a serial port of the emulated board, in simulated time: each run gives the same frames.

>>> # with Emulator(elf, usb={"seed": 3, "open": False}) as pico, BoardAgent(pico) as agent:
>>> #     agent.run_until(lambda: agent.running, milliseconds=2000)
>>> #     agent.topics.publish("rt/pan_subscriber", float64(0.5))
>>> #     agent.run(milliseconds=100)
"""

from __future__ import annotations

import struct
from collections.abc import Callable, Hashable
from dataclasses import dataclass
from typing import Any, Protocol

from tests.doubles.rp2040.emulator import CYCLES_PER_MILLISECOND, Emulator
from tests.doubles.xrce_agent.agent import Agent
from tests.doubles.xrce_agent.framing import AGENT, Deframer, frame
from tests.doubles.xrce_agent.topics import Endpoint, Topics

CLOCK = 1000 * CYCLES_PER_MILLISECOND
HEARTBEAT = 0.2
"""Seconds between two heartbeats of the agent."""
SLICE = 0.005
"""Seconds after which the agent checks its timers even if no frame has arrived."""


class Board(Protocol):
    """A simulated board.  ``cycle``: its time, in cycles of 8 ns."""

    @property
    def cycle(self) -> int: ...
    def run(self, *, milliseconds: float, **stop: Any) -> Any: ...


@dataclass(frozen=True)
class Said:
    """A sample of the board; ``time`` in simulated seconds."""

    time: float
    topic: str
    data: bytes


class UsbLink:
    """A serial port over USB, opened as a terminal opens it: the board sees DTR."""

    address = "usb"
    checked = True  # frames have a CRC

    def __init__(self, pico: Emulator, port: int = 0) -> None:
        self._pico, self._port = pico, port
        self.is_open = False
        self._deframer = Deframer()

    @property
    def stop(self) -> dict[str, object]:
        """The emulator's condition for "a byte has arrived"."""
        return {"data": True, "port": self._port}

    @property
    def broken(self) -> int:
        """Number of frames from the board that were not valid."""
        return self._deframer.broken

    def open(self) -> None:
        if not self.is_open:
            self.is_open = True
            self._deframer = Deframer()
            self._pico.receive_bytes(port=self._port)
            self._pico.call("usb_open", port=self._port)

    def close(self) -> None:
        if self.is_open:
            self.is_open = False
            self._pico.call("usb_open", open=False, port=self._port)

    def fileno(self) -> int:
        return -1

    def receive(self) -> list[tuple[Hashable, bytes]]:
        return [*self._deframer.feed(self._pico.receive_bytes(port=self._port))]

    def raw(self, peer: Hashable, data: bytes) -> bytes:
        assert isinstance(peer, int)
        return frame(data, AGENT, peer)

    def send_raw(self, peer: Hashable, data: bytes) -> None:
        if self.is_open:
            self._pico.send(data, port=self._port)


class UartLink(UsbLink):
    """A UART of the chip, connected to the agent's computer."""

    address = "uart"

    def __init__(self, pico: Emulator, uart: int, baud: int) -> None:
        super().__init__(pico)
        self._uart, self._baud = uart, baud

    @property
    def stop(self) -> dict[str, object]:
        return {"data": True, "port": f"uart{self._uart}"}

    def open(self) -> None:
        self.is_open = True
        self._pico.call("uart_send", uart=self._uart, baud=self._baud)

    def close(self) -> None:
        self.is_open = False

    def receive(self) -> list[tuple[Hashable, bytes]]:
        data = bytes.fromhex(self._pico.call("uart_receive", uart=self._uart))
        return [*self._deframer.feed(data)] if self.is_open else []

    def send_raw(self, peer: Hashable, data: bytes) -> None:
        if self.is_open:
            self._pico.call("uart_send", uart=self._uart, hex=data.hex())


class BoardAgent(Agent):
    """An agent without a thread: it works while the test lets time pass."""

    def __init__(self, pico: Board, link: UsbLink | None = None, seed: int = 1, topics: Topics | None = None) -> None:
        self.pico = pico
        if link is None:
            assert isinstance(pico, Emulator)
            link = UsbLink(pico)
        self.serial = link
        self.said: list[Said] = []
        self._next_beat = 0.0
        super().__init__(self.serial, topics, seed=seed, heartbeat=HEARTBEAT, clock=self.now)
        self.topics.taps.append(self._hear)

    def now(self) -> float:
        """Simulated time in seconds."""
        return self.pico.cycle / CLOCK

    def _run(self) -> None:
        """Does nothing: there is no thread."""

    def _now(self) -> bytes:
        """A time in the year 2026, the same in each run."""
        seconds, fraction = divmod(self.pico.cycle, CLOCK)
        return struct.pack("<iI", 1_790_000_000 + seconds, fraction * 10**9 // CLOCK)

    def _hear(self, writer: Endpoint, data: bytes) -> None:
        self.said.append(Said(self.now(), writer.topic, data))

    def heard(self, topic: str, since: float = 0.0) -> list[Said]:
        """The messages of a topic that the board has published from ``since`` on."""
        return [sample for sample in self.said if sample.topic == topic and sample.time >= since]

    def wait_for(self, topic: str, milliseconds: float = 2000) -> Said:
        """The next sample of a topic."""
        before = len(self.said)

        def new() -> list[Said]:
            return [sample for sample in self.said[before:] if sample.topic == topic]

        assert self.run_until(lambda: bool(new()), milliseconds), (
            f"nothing on {topic} within {milliseconds} ms; {self.tail()}"
        )
        return new()[0]

    def call(self, service: str, request: bytes, milliseconds: float = 1000) -> bytes:
        """The reply to a request."""
        identity = self.topics.ask(service, request)
        assert self.run_until(lambda: bool(self.topics.answers(service, identity)), milliseconds), (
            f"no answer of {service} within {milliseconds} ms; {self.tail()}"
        )
        return self.topics.answers(service, identity)[0]

    def turn(self) -> None:
        """Does the work that is due."""
        if not self._alive or self._frozen:
            return
        self._receive()
        self._run_later()
        if self.now() >= self._next_beat:
            self._next_beat = self.now() + HEARTBEAT
            self._beat()

    def run(self, milliseconds: float) -> None:
        self.run_until(lambda: False, milliseconds)

    def run_until(self, condition: Callable[[], bool], milliseconds: float) -> bool:
        """Lets time pass until ``condition`` is true, at most this long; True if it became true."""
        end = self.pico.cycle + round(milliseconds * CYCLES_PER_MILLISECOND)
        while not condition():
            left = (end - self.pico.cycle) / CYCLES_PER_MILLISECOND
            if left <= 0:
                return False
            wait = min(left, 1000 * SLICE)
            if self._later:
                wait = min(wait, max(0.01, 1000 * (self._later[0][0] - self.now())))
            listening = self._alive and not self._frozen
            self.pico.run(milliseconds=wait, **(self.serial.stop if listening else {}))
            self.turn()
        return True
