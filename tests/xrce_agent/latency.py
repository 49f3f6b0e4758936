# SPDX-License-Identifier: Apache-2.0
"""The time from a setpoint at the agent to the output that it changes, and the control cycle that changes it."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

PROJECT = "benchmarks/latency"
DELAYS = (0, 500)
"""Output delays of the benchmark's targets, in us; 0: none."""
PERIOD = 0.001
TOPIC = "rt/setpoint"


@dataclass(frozen=True)
class Step:
    """A setpoint that differs from the one before; times in s."""

    whole: float
    """From publishing at the agent to the output."""
    after_arrival: float
    """From the moment at which the control side can read the value to the output."""
    cycles: int
    """Number of cycles that began after that, up to the cycle of the output.  1: the next cycle; 0: a cycle that had
    just begun but had not read its setpoints yet."""
    in_cycle: float
    """From the tick (on the host: the start of the cycle) to the output."""


def executable(delay: int, target: str) -> str:
    return f"latency_{delay}_{target}"


def duty(number: int) -> float:
    """The duty of step ``number``.  It differs from that of every other step, even in a PWM of 6250 levels."""
    return 0.1 + 0.8 * (number * 0.38196601125 % 1.0)


def parse(path: Path, sent: list[float]) -> list[Step]:
    """The records that the host's program wrote, for steps sent at these times of the monotonic clock."""
    begun = {duty(number): time for number, time in enumerate(sent)}
    steps = []
    for line in path.read_text(encoding="utf-8").splitlines():
        words = line.split()
        value, numbers = float(words[0]), [int(word) for word in words[1:]]
        if value not in begun:
            continue
        arrival, arrival_cycle, begin, cycle, written = numbers
        # the cycle ran before the arrival was recorded: it belongs to the step before
        if 1e-9 * arrival < begun[value]:
            arrival, arrival_cycle = begin, cycle
        whole = 1e-9 * written - begun[value]
        steps.append(Step(whole, 1e-9 * (written - arrival), cycle - arrival_cycle, 1e-9 * (written - begin)))
    return steps
