# SPDX-License-Identifier: Apache-2.0
"""The serial port of an emulated board for an agent outside the emulator, which runs in real time.

>>> # line = Line(pico)
>>> # with RealAgent(["serial", "-b", "115200", "--dev", line.path], domain, folder):
>>> #     line.run(100)
"""

from __future__ import annotations

import contextlib
import os
import select
import tty
from collections.abc import Callable

from tests.doubles.rp2040.emulator import CYCLES_PER_MILLISECOND, Emulator

from .board import AGENT_PORT

STEP = 1.0
"""Milliseconds of the emulated chip between two exchanges of bytes."""


class Line:
    """A pseudo terminal for the agent at one end, and the board's USB port at the other."""

    def __init__(self, pico: Emulator) -> None:
        self.pico = pico
        self._master, self._slave = os.openpty()
        tty.setraw(self._slave)
        os.set_blocking(self._master, False)
        self.path = os.ttyname(self._slave)
        pico.call("usb_open", port=AGENT_PORT)

    def run(self, milliseconds: float) -> None:
        self.run_until(lambda: False, milliseconds)

    def run_until(self, condition: Callable[[], bool], milliseconds: float) -> bool:
        """Lets time pass on the chip until ``condition`` is true, at most this long; True if it became true."""
        end = self.pico.cycle + round(milliseconds * CYCLES_PER_MILLISECOND)
        while not condition():
            if self.pico.cycle >= end:
                return False
            if select.select([self._master], [], [], 0)[0]:
                self.pico.send(os.read(self._master, 4096), port=AGENT_PORT)
            self.pico.run(milliseconds=STEP)
            data = self.pico.receive_bytes(port=AGENT_PORT)
            with contextlib.suppress(OSError):  # bytes that the agent does not read are lost
                os.write(self._master, data)
        return True

    def close(self) -> None:
        os.close(self._master)
        os.close(self._slave)
