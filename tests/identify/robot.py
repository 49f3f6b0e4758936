# SPDX-License-Identifier: Apache-2.0
"""A motor with the physics of JIWY's plant, integrated in small steps: independent of the solution in epg.identify."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

STEPS = 20  # of the integration in each row


@dataclass(frozen=True)
class Physics:
    """A DC motor on an H-bridge with a gear: SI units, inertia and friction at the motor."""

    supply: float = 12.0
    constant: float = 0.018
    resistance: float = 12.0
    inertia: float = 1.037e-6
    viscous: float = 2.324e-6
    coulomb: float = 1.8e-4
    gear: float = 1 / 19

    @property
    def gain(self) -> float:
        return self.gear * self.supply * self.constant / (self.resistance * self.viscous + self.constant**2)

    @property
    def time_constant(self) -> float:
        return self.resistance * self.inertia / (self.resistance * self.viscous + self.constant**2)

    @property
    def friction(self) -> float:
        return self.resistance * self.coulomb / (self.constant * self.supply)


@dataclass(frozen=True)
class Run:
    """Rows of a recording."""

    time: list[float]
    position: list[float]
    duty: list[float]

    def write(self, path: Path) -> Path:
        rows = zip(self.time, self.duty, self.position, strict=True)
        lines = [f"{time:.6f},{duty:.9g},{position:.9g}\n" for time, duty, position in rows]
        path.write_text("time,duty,position\n" + "".join(lines), encoding="utf-8")
        return path


def plan(*parts: tuple[float, float]) -> Callable[[float, float], float]:
    """The duty of parts (length in s, duty), one after another; 0 at the end."""

    def duty(time: float, position: float) -> float:
        begin = 0.0
        for length, value in parts:
            begin += length
            if time < begin - 1e-9:
                return value
        return 0.0

    return duty


JOG = plan((0.1, 0.0), (0.25, 0.15), (0.3, 0.0))
BOTH = plan((0.1, 0.0), (0.25, 0.15), (0.3, 0.0), (0.25, -0.15), (0.3, 0.0))


# One function, because it is one integration.
def drive(
    physics: Physics,
    duty: Callable[[float, float], float],
    length: float,
    period: float = 0.001,
    resolution: float = math.pi / 1112,
    *,
    noise: Sequence[float] = (0.0,),
    delay: int = 0,
    speed: float = 0.0,
    phase: float = 0.3,
    stop: float = math.inf,
) -> Run:
    """A run of ``length`` s.  ``duty(time, position)`` is called in each row; ``delay`` rows pass until it acts.

    ``resolution`` is that of the encoder, ``phase`` the part of a count at the start; ``speed`` is the first speed of
    the load.  ``stop`` is the position of an end stop.
    """
    position, omega = 0.0, speed / physics.gear
    pending = [0.0] * delay
    time, positions, duties = [], [], []
    step = period / STEPS
    for row in range(round(length / period)):
        seen = position + noise[row % len(noise)]
        counted = math.floor(seen / resolution + phase) * resolution if resolution else seen
        wanted = duty(row * period, counted)
        time.append(row * period)
        positions.append(counted)
        duties.append(wanted)
        pending.append(wanted)
        acting = pending.pop(0)
        for _ in range(STEPS):
            current = (physics.supply * acting - physics.constant * omega) / physics.resistance
            torque = physics.constant * current - physics.viscous * omega
            if omega == 0.0 and abs(torque) <= physics.coulomb:
                continue
            torque -= math.copysign(physics.coulomb, omega or torque)
            new = omega + step * torque / physics.inertia
            new = 0.0 if omega and new * omega < 0.0 else new
            position += step * physics.gear * 0.5 * (omega + new)
            omega = new
            if position > stop:
                position, omega = stop, 0.0
    return Run(time, positions, duties)
