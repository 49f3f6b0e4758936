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
    after_tick: float
    """From the tick to the output.  On a computer that is late, the cycle starts after its tick."""


def executable(delay: int, target: str) -> str:
    return f"latency_{delay}_{target}"


def duty(number: int) -> float:
    """The duty of step ``number``.  It differs from that of every other step, even in a PWM of 6250 levels."""
    return 0.1 + 0.8 * (number * 0.38196601125 % 1.0)


def parse(path: Path, sent: list[float], cycles: list[dict[str, float]]) -> list[Step]:
    """The records that the host's program wrote, for steps sent at these times of the monotonic clock.

    ``cycles`` is the program's trace, which has the tick of each cycle, and how late it started.
    """
    begun = {duty(number): time for number, time in enumerate(sent)}
    lines = [line.split() for line in path.read_text(encoding="utf-8").splitlines()]
    records = [(float(value), [int(number) for number in numbers]) for value, *numbers in lines]
    traced = [(1e-9 * numbers[2], cycles[numbers[3] - 1]) for _, numbers in records]
    start = min(begin - cycle["time"] - cycle["lateness"] for begin, cycle in traced)
    steps = []
    for value, numbers in records:
        if value not in begun:
            continue
        arrival, arrival_cycle, begin, cycle, written = numbers
        # the cycle ran before the arrival was recorded: it belongs to the step before
        if 1e-9 * arrival < begun[value]:
            arrival, arrival_cycle = begin, cycle
        whole = 1e-9 * written - begun[value]
        after_tick = 1e-9 * written - start - cycles[cycle - 1]["time"]
        in_cycle = 1e-9 * (written - begin)
        steps.append(Step(whole, 1e-9 * (written - arrival), cycle - arrival_cycle, in_cycle, after_tick))
    return steps
