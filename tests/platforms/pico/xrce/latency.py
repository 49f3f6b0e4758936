# SPDX-License-Identifier: Apache-2.0
"""Steps of a setpoint that is sent to an emulated Pico by USB, until the level of its PWM takes effect."""

from __future__ import annotations

import random
from bisect import bisect_right
from pathlib import Path

from tests.doubles.rp2040.build import build
from tests.doubles.rp2040.emulator import Emulator
from tests.doubles.xrce_agent.messages import float64
from tests.middlewares.xrce.steps import DELAYS, PROJECT, TOPIC, Step, duty, executable

from .agent import CLOCK, BoardAgent

SLICE = 1
SPANS = {"tick": ("on_wrap", 1), "given": ("epg_control_receive", 0)}
"""Functions and their cores: the control cycle's interrupt, and the delivery of a setpoint to the control side."""


def programs(platform: str) -> dict[int, Path]:
    """Images by output delay in us; SDK and compiler must be installed."""
    target = f"rpi_pico_{platform}"
    folder = build(
        PROJECT,
        targets=[executable(delay, target) for delay in DELAYS],
        variables={"LATENCY_TARGET": target},
    )
    return {delay: folder / f"{executable(delay, target)}.elf" for delay in DELAYS}


def measure(image: Path, count: int, seed: int = 1) -> list[Step]:
    """Sends ``count`` steps, 3 to 7 ms apart; ``seed`` determines phase and clock error of the USB host."""
    draw = random.Random(seed)
    usb = {"seed": seed, "phase": draw.uniform(0, 1000), "clock_error": draw.uniform(-500, 500), "open": False}
    with Emulator(image, usb=usb) as pico:
        pico.run(milliseconds=40)
        with BoardAgent(pico) as agent:
            assert agent.run_until(lambda: any(client.readings for client in agent.clients.values()), 2000)
            agent.run(100)
            for name, (symbol, core) in SPANS.items():
                pico.call("watch_span", name=name, core=core, **{"from": symbol, "to": "return"})
            pico.call("watch_pwm", slices=[SLICE])
            sent = []
            for number in range(count):
                agent.run(draw.uniform(3, 7))
                sent.append(pico.cycle)
                agent.topics.publish(TOPIC, float64(duty(number)), reliable=False)
            agent.run(5)
            assert pico.call("faults") == []
        ticks = [begin for begin, *_ in pico.call("span", name="tick")["passages"]]
        given = [begin + length for begin, length, _ in pico.call("span", name="given")["passages"]]
        levels = [entry[0] for entry in pico.call("take", log="pwm") if entry[0] > sent[0]]
    return evaluate(sent, given, ticks, levels)


def evaluate(sent: list[int], given: list[int], ticks: list[int], levels: list[int]) -> list[Step]:
    """Evaluates lists in cycles of 8 ns, each in its order; none may have gaps."""
    assert len(given) == len(levels) == len(sent)
    steps = []
    for begin, arrival, level in zip(sent, given, levels, strict=True):
        assert begin < arrival < level
        tick = bisect_right(ticks, level) - 1
        cycles = tick - (bisect_right(ticks, arrival) - 1)
        in_cycle = (level - ticks[tick]) / CLOCK
        steps.append(Step((level - begin) / CLOCK, (level - arrival) / CLOCK, cycles, in_cycle, after_tick=in_cycle))
    return steps
