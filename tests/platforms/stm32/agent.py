# SPDX-License-Identifier: Apache-2.0
"""The XRCE agent at the UART of the emulated STM32H743, in simulated time.

>>> # jiwy = Jiwy("bare_metal", "xrce")
>>> # agent = agent_of(jiwy)
>>> # agent.topics.publish("rt/pan_subscriber", float64(0.5), reliable=False)
>>> # agent.run(100)                                           # milliseconds
"""

from __future__ import annotations

from collections.abc import Hashable
from typing import Any

from tests.doubles.stm32.agenda import UNITS
from tests.doubles.xrce_agent.framing import Deframer
from tests.platforms.pico.xrce.agent import CLOCK, BoardAgent, UsbLink
from tests.platforms.stm32.jiwy import Jiwy


class Steps:
    """Time passes by whole control cycles, because the robot moves between them."""

    def __init__(self, jiwy: Jiwy) -> None:
        self.jiwy = jiwy

    @property
    def cycle(self) -> int:
        return self.jiwy.chip.now * CLOCK // UNITS

    def run(self, *, milliseconds: float, **_: Any) -> None:
        """Only the next cycle: what the board sends within it reaches the agent after it."""
        del milliseconds
        self.jiwy.run(1)


class UartLink(UsbLink):
    """The UART, connected to the agent's computer.  While the agent is not there, its bytes are lost."""

    address = "uart"

    def __init__(self, jiwy: Jiwy) -> None:
        self.line = jiwy.line
        self.is_open = False
        self._deframer = Deframer()

    @property
    def stop(self) -> dict[str, object]:
        return {}

    def open(self) -> None:
        if not self.is_open:
            self.is_open = True
            self._deframer = Deframer()
            self.line.take()

    def close(self) -> None:
        self.is_open = False

    def receive(self) -> list[tuple[Hashable, bytes]]:
        return [*self._deframer.feed(self.line.take())]

    def send_raw(self, peer: Hashable, data: bytes) -> None:
        if self.is_open:
            self.line.send(data)


def agent_of(jiwy: Jiwy) -> BoardAgent:
    """An agent that has received the first message of the board."""
    agent = BoardAgent(Steps(jiwy), UartLink(jiwy))
    agent.wait_for("rt/pan_publisher")
    return agent
