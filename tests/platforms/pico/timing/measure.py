# SPDX-License-Identifier: Apache-2.0
"""The times of a program's ticks, encoder reads and PWM levels, measured by the emulator, to the cycle of 8 ns.

For every control cycle k, these deviate from t0 + k T: the first instruction of the tick, the encoder reads, and the
PWM wrap at which a level that the cycle has written takes effect.  The firmware's own clock is not used.  Contention
for the bus and the flash cache is not simulated.
"""

from __future__ import annotations

import math
import random
import re
from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass, field
from pathlib import Path

from tests.doubles.rp2040.emulator import Emulator
from tests.platforms.pico.closed_loop.robot import PERIOD, connect

from .programs import Program

SPANS = {"tick": "on_wrap", "read": "epg_port_quadrature_count", "write": "epg_port_pwm_write"}
"""The functions that are timed, on core 1."""
MOTOR_SLICES = (1, 2)
MOST_UNANSWERED = 3
"""Number of setpoints that the host sends before it waits for an answer."""
LINES = 2000
"""Number of lines in the text that floods USB, before it repeats."""


@dataclass(frozen=True)
class Load:
    """``period`` of communication in ms; ``flooded``: always as many packets as USB can carry, in both directions."""

    period: int
    flooded: bool = False

    @property
    def title(self) -> str:
        return f"{self.period} ms" + (", flooded" if self.flooded else "")


LOADS = (Load(33), Load(10), Load(1), Load(33, flooded=True))


@dataclass
class Timing:
    """Deviations in cycles of 8 ns; each mapping counts the occurrences of each deviation."""

    cycles: int = 0
    missed: int = 0
    overruns: int = 0
    entry: Counter[int] = field(default_factory=Counter)
    first_read: Counter[int] = field(default_factory=Counter)
    last_read: Counter[int] = field(default_factory=Counter)
    written: Counter[int] = field(default_factory=Counter)
    actuation: Counter[int] = field(default_factory=Counter)
    received: int = 0

    def add(self, other: Timing) -> None:
        for name, value in vars(other).items():
            if isinstance(value, Counter):
                getattr(self, name).update(value)
            else:
                setattr(self, name, getattr(self, name) + value)


def measure(program: Program, load: Load, seed: int, seconds: float, *, image: Path | None = None) -> Timing:
    """Runs ``program`` from reset for this many simulated seconds: homing, then a motion of both axes.

    ``image``: of the program, if it is already built.  ``seed`` determines phase and clock error (+-500 ppm) of the USB
    host.
    """
    draw = random.Random(seed)
    phase, clock_error = draw.uniform(0, 1000), draw.uniform(-500, 500)
    usb = {"seed": seed, "phase": phase, "clock_error": clock_error}
    with Emulator(image or program.image(), usb=usb) as pico:
        connect(pico, {"pan": 0.12, "tilt": 0.12})
        for name, symbol in SPANS.items():
            pico.call("watch_span", name=name, core=1, **{"from": symbol, "to": "return"})
        pico.call("watch_pwm", slices=list(MOTOR_SLICES))
        pico.run(milliseconds=500, configured=True)
        pico.run(milliseconds=5)
        pico.send("watch pan_publisher\n")
        received = _exercise(pico, load, draw, seconds)
        timing = evaluate(*(pico.call("span", name=name)["passages"] for name in SPANS),
                          pico.call("take", log="pwm"))  # fmt: skip
        timing.received = received
        timing.overruns = _overruns(pico)
        assert pico.call("faults") == []
    return timing


def _exercise(pico: Emulator, load: Load, draw: random.Random, seconds: float) -> int:
    """Sends setpoints for this time, if necessary as fast as answers come; returns the number of received bytes."""
    start, received, unanswered = pico.cycle, 0, 0
    if load.flooded:
        pico.call("usb_flood", text="".join(_flood_lines(draw)))
    step = 33 if load.flooded else load.period
    rate, offset = draw.uniform(2, 4), draw.uniform(0, math.tau)
    while (time := (pico.cycle - start) / (1000 * PERIOD)) < seconds:
        if not load.flooded and unanswered < MOST_UNANSWERED:
            pico.send(_setpoints(rate * time + offset))
            unanswered += 1
        pico.run(milliseconds=step * draw.uniform(0.98, 1.02))
        said = pico.receive()
        received += len(said)
        unanswered = max(0, unanswered - said.count("ok setpoint"))
    if load.flooded:
        pico.call("usb_flood", on=False)
    return received


def _setpoints(angle: float) -> str:
    return f"pan_subscriber={0.6 + 0.4 * math.sin(angle):.6f} tilt_subscriber={0.6 + 0.4 * math.cos(angle):.6f}\n"


def _flood_lines(draw: random.Random) -> Iterable[str]:
    for number in range(LINES):
        yield _setpoints(math.tau * number / LINES)
        yield draw.choice(("stats\n", "ports\n", "help\n", "nonsense\n", "\xff\x00?\n"))


def _overruns(pico: Emulator) -> int:
    """Overruns as the firmware counts them; asserts that the firmware still drives the motors."""
    pico.run(milliseconds=300)
    pico.receive()
    pico.send("\nstats\n")
    said = pico.run_until_text("ok stats", milliseconds=3000)
    assert re.search(r"enabled=1", said), said
    found = re.search(r"stat overruns=(\d+)", said)
    assert found is not None
    return int(found[1])


Passages = list[list[int]]


def evaluate(ticks: Passages, reads: Passages, writes: Passages, taken: Passages) -> Timing:
    """Evaluates the spans of a run; each passage is [cycle, cycles, instructions]."""
    timing = Timing(cycles=len(ticks))
    entries = [cycle for cycle, *_ in ticks]
    zero = entries[0] + _commonest((entry - entries[0]) for entry in entries)
    numbers = [round((entry - zero) / PERIOD) for entry in entries]
    timing.entry.update(entry - zero - number * PERIOD for entry, number in zip(entries, numbers, strict=True))
    timing.missed = numbers[-1] - numbers[0] + 1 - len(set(numbers))

    firsts, lasts, ends = [], [], []
    position = {"read": 0, "write": 0}
    for (begin, length, _), number in zip(ticks, numbers, strict=True):
        inside = _inside(reads, begin, begin + length, position, "read")
        firsts.append(inside[0][0] - zero - number * PERIOD)
        lasts.append(inside[-1][0] - zero - number * PERIOD)
        outputs = _inside(writes, begin, begin + length, position, "write")
        if outputs:
            ends.append(outputs[-1][0] + outputs[-1][1] - zero - number * PERIOD)
    for counter, phases in ((timing.first_read, firsts), (timing.last_read, lasts)):
        reference = Counter(phases).most_common(1)[0][0]
        counter.update(phase - reference for phase in phases)
    timing.written.update(ends)

    instants = [(entry[0] - zero) % PERIOD for entry in taken if entry[0] > entries[0]]
    if instants:
        reference = Counter(instants).most_common(1)[0][0]
        timing.actuation.update(instant - reference for instant in instants)
    return timing


def _commonest(distances: Iterable[int]) -> int:
    """The most frequent distance modulo a period, nearest to 0."""
    phase = Counter(distance % PERIOD for distance in distances).most_common(1)[0][0]
    return phase if phase < PERIOD // 2 else phase - PERIOD


def _inside(passages: Passages, begin: int, end: int, position: dict[str, int], name: str) -> Passages:
    """Passages within a span; spans must be requested in their order."""
    at = position[name]
    while at < len(passages) and passages[at][0] < begin:
        at += 1
    first = at
    while at < len(passages) and passages[at][0] < end:
        at += 1
    position[name] = at
    return passages[first:at]
