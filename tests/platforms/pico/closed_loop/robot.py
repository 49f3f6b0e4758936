# SPDX-License-Identifier: Apache-2.0
"""JIWY on the pins of a simulated Pico: motors behind its H-bridges, and the encoders that they turn.

>>> # with Emulator(elf) as pico:
>>> #     connect(pico, {"pan": 1.2, "tilt": 0.7})
>>> #     pico.run(milliseconds=100)
>>> #     angle(pico, "pan")
"""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping
from dataclasses import dataclass

from tests.doubles.rp2040.emulator import CYCLES_PER_MILLISECOND, Emulator

PERIOD = CYCLES_PER_MILLISECOND
"""Cycles of 8 ns in a control period."""
MOTOR_PERIOD = 6250
"""Cycles of the motors' PWM, at 20 kHz."""
WRAP_EXCEPTION = 16 + 4
"""PWM_IRQ_WRAP: RP2040 data sheet, 2.3.2."""


@dataclass(frozen=True)
class Axis:
    """Wiring of targets/robots/jiwy/rpi_pico_jiwy.tcf.  ``upper`` is the angle of the far end stop; homing finds 0."""

    name: str
    encoder_a: int
    encoder_b: int
    slice: int
    direction_a: int
    direction_b: int
    upper: float
    counts: int

    @property
    def rad_per_count(self) -> float:
        return self.upper / self.counts

    @property
    def value_pin(self) -> int:
        return 2 * self.slice

    @property
    def outputs(self) -> tuple[int, int, int]:
        return (self.value_pin, self.direction_a, self.direction_b)


AXES = (
    Axis("pan", encoder_a=10, encoder_b=11, slice=1, direction_a=7, direction_b=8, upper=math.pi, counts=1112),
    Axis("tilt", encoder_a=12, encoder_b=13, slice=2, direction_a=5, direction_b=6, upper=math.pi / 2, counts=221),
)


def connect(pico: Emulator, angles: Mapping[str, float], *, swapped: Collection[str] = ()) -> None:
    """Connects both axes to the pins, at ``angles`` in rad; A and B of the axes in ``swapped`` are exchanged."""
    for axis in AXES:
        a, b = axis.encoder_a, axis.encoder_b
        if axis.name in swapped:
            a, b = b, a
        pico.call("encoder", name=axis.name, a=a, b=b)
        bridge = {"slice": axis.slice, "channel": 0, "pinA": axis.direction_a, "pinB": axis.direction_b}
        where = {"stops": [0, axis.upper], "angle": angles[axis.name]}
        pico.call("motor", name=axis.name, encoder=axis.name, bridge=bridge, axis=axis.name, **where)


def angle(pico: Emulator, axis: str) -> float:
    """Angle of the camera, in rad from the end stop that homing finds."""
    return float(pico.call("motor_state", name=axis)["angle"])


def first_tick(pico: Emulator, *, core: int = 1, milliseconds: int = 200) -> int:
    """Runs until ``core`` has entered its first tick; returns the cycle of the entry."""
    pico.call("watch_exceptions", numbers=[WRAP_EXCEPTION])
    for _ in range(milliseconds):
        pico.run(milliseconds=1)
        taken = pico.call("take", log="exceptions")
        entries = [cycle for cycle, where, _, entered in taken if entered and where == core]
        if entries:
            return int(entries[0])
    raise AssertionError(f"no tick within {milliseconds} ms; {pico.call('state')}")
