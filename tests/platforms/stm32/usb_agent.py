# SPDX-License-Identifier: Apache-2.0
"""The XRCE agent at the first serial port on USB of the emulated STM32H743, in simulated time.

>>> # agent = agent_on_usb(chip, host)
>>> # agent.run(100)                                           # milliseconds
"""

from __future__ import annotations

from collections.abc import Hashable
from typing import Any

from tests.doubles.stm32.agenda import UNITS
from tests.doubles.stm32.machine import Machine
from tests.doubles.stm32.usb_host import UsbHost
from tests.doubles.xrce_agent.framing import Deframer
from tests.platforms.pico.xrce.agent import CLOCK, BoardAgent, UsbLink

SLICE = 0.5
"""Milliseconds between two looks at what has arrived."""


class Steps:
    def __init__(self, chip: Machine) -> None:
        self.chip = chip

    @property
    def cycle(self) -> int:
        return self.chip.now * CLOCK // UNITS

    def run(self, *, milliseconds: float, **_: Any) -> None:
        self.chip.run(min(milliseconds, SLICE) / 1000)


class PortLink(UsbLink):
    """The port, which the agent opens again after each enumeration."""

    def __init__(self, host: UsbHost) -> None:
        self._host = host
        self.is_open = False
        self._deframer = Deframer()

    @property
    def stop(self) -> dict[str, object]:
        return {}

    def open(self) -> None:
        self.is_open = True

    def close(self) -> None:
        self.is_open = False
        if self._host.configured:
            self._host.ports[0].close()

    def receive(self) -> list[tuple[Hashable, bytes]]:
        if not self.is_open or not self._host.configured:
            return []
        port = self._host.ports[0]
        if not port.is_open:
            self._deframer = Deframer()
            port.open()
        return [*self._deframer.feed(port.take())]

    def send_raw(self, peer: Hashable, data: bytes) -> None:
        if self.is_open and self._host.configured:
            self._host.ports[0].send(data)


def agent_on_usb(chip: Machine, host: UsbHost) -> BoardAgent:
    """An agent that has received the first message of the board."""
    agent = BoardAgent(Steps(chip), PortLink(host))  # type: ignore[arg-type]
    agent.wait_for("rt/pan_publisher")
    return agent
