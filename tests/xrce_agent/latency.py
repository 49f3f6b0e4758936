# SPDX-License-Identifier: Apache-2.0
"""How long a setpoint takes from the agent to the output that it changes, and in which control cycle that happens."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

PROJECT = "benchmarks/latency"
DELAYS = (0, 500)
"""Output delays of its targets, in us; 0: none."""
PERIOD = 0.001
TOPIC = "rt/setpoint"


@dataclass(frozen=True)
class Step:
    """A setpoint that differs from the one before; times in s."""

    whole: float
    """From the agent's publishing to the output."""
    after_arrival: float
    """From the control side's being given the value to the output."""
    cycles: int
    """Cycles that began after that, up to the one of the output: 1 is the next; 0 is one that had just begun, and had
    not taken its setpoints yet."""
    in_cycle: float
    """From the tick (on the host from the cycle's begin) to the output."""


def executable(delay: int, target: str) -> str:
    return f"latency_{delay}_{target}"


def duty(number: int) -> float:
    """Of step ``number``: each differs from the one before and can be told from it in a PWM of 6250 steps."""
    return 0.1 + 0.8 * (number * 0.38196601125 % 1.0)


def parse(path: Path, sent: list[float]) -> list[Step]:
    """What the host's program has written, of the steps that were sent at these times of the monotonic clock."""
    begun = {duty(number): time for number, time in enumerate(sent)}
    steps = []
    for line in path.read_text(encoding="utf-8").splitlines():
        words = line.split()
        value, numbers = float(words[0]), [int(word) for word in words[1:]]
        if value not in begun:
            continue
        arrival, arrival_cycle, begin, cycle, written = numbers
        if 1e-9 * arrival < begun[value]:  # the cycle has come before the arrival was noted: it is of the step before
            arrival, arrival_cycle = begin, cycle
        whole = 1e-9 * written - begun[value]
        steps.append(Step(whole, 1e-9 * (written - arrival), cycle - arrival_cycle, 1e-9 * (written - begin)))
    return steps
