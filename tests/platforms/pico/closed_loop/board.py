# SPDX-License-Identifier: Apache-2.0
"""JIWY's firmware with the robot on its pins and a test at its console.

>>> # with Board(image("bare_metal"), {"pan": 0.12, "tilt": 0.12}) as board:
>>> #     board.home()
>>> #     board.ask("pan_subscriber=0.5 tilt_subscriber=0.5")
>>> #     board.stats()["fault"]
"""

from __future__ import annotations

import re
from collections.abc import Collection, Mapping, Sequence
from pathlib import Path
from typing import Any

from tests.doubles.rp2040.emulator import Emulator
from tests.platforms.pico.images import images

from .robot import AXES, Axis, connect

HOMED = 900
"""Milliseconds after which both axes have homed from 0.12 rad and have stopped."""


def image(platform: str) -> Path:
    """The predefined target of an RP2040 platform, as EPG's own executable."""
    return images("pico", platform, "jiwy_firmware", middleware="console") / "jiwy_firmware.elf"


class Board:
    """A Pico after its start, with its console open."""

    def __init__(self, elf: Path, angles: Mapping[str, float], *, swapped: Collection[str] = (), **usb: Any) -> None:
        self.pico = Emulator(elf, usb={"seed": 3, **usb})
        connect(self.pico, angles, swapped=swapped)
        self.pico.call("watch_pins", pins=[pin for axis in AXES for pin in axis.outputs])
        self.pico.run_until_text("ready", milliseconds=500)

    def __enter__(self) -> Board:
        return self

    def __exit__(self, *_: object) -> None:
        self.pico.close()

    def home(self) -> None:
        self.pico.run(milliseconds=HOMED)
        for axis in AXES:
            assert abs(self.motor(axis.name)["angle"]) < axis.rad_per_count, "homed"

    def ask(self, command: str) -> str:
        """Sends a command; returns the text up to the end of the answer."""
        word = "setpoint" if "=" in command.split()[0] else command.split()[0]
        self.pico.receive()
        self.pico.send(command + "\n")
        return self.pico.run_until_text(f"ok {word}")

    def stats(self) -> dict[str, str]:
        return dict(re.findall(r"(\w+)=(\S+)", self.ask("stats")))

    def motor(self, axis: str) -> dict[str, Any]:
        found: dict[str, Any] = self.pico.call("motor_state", name=axis)
        return found

    def is_safe(self, *axes: Axis) -> bool:
        """True if there is no pulse and no direction: the inputs of the bridges are low."""
        return all(self.pico.call("pin", pin=pin)["level"] == 0 for axis in axes for pin in axis.outputs)

    def run_until_safe(self, *axes: Axis, milliseconds: int) -> int:
        """Runs until all of ``axes`` are safe; returns the cycle of the last edge on their pins."""
        last = -1
        for _ in range(milliseconds):
            self.pico.run(milliseconds=1)
            edges = self._edges(axes)
            last = edges[-1] if edges else last
            if self.is_safe(*axes) and not edges:
                return last
        raise AssertionError(f"not safe after {milliseconds} ms: {self.stats()}")

    def assert_stays_safe(self, *axes: Axis, milliseconds: float) -> None:
        self._edges(axes)
        assert self.is_safe(*axes)
        self.pico.run(milliseconds=milliseconds)
        assert self._edges(axes) == []

    def _edges(self, axes: Sequence[Axis]) -> list[int]:
        """The cycles at which pins of ``axes`` have changed since the last call."""
        watched = {pin for axis in axes for pin in axis.outputs}
        return [cycle for cycle, pin, *_ in self.pico.call("take", log="pins") if pin in watched]
