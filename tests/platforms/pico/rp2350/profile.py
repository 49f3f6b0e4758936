# SPDX-License-Identifier: Apache-2.0
"""The control cycle of an RP2350 image with the inputs of a motion on the host, cycle by cycle."""

from __future__ import annotations

import struct
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial

from tests.doubles.rp2350.cortex_m33 import Processor
from tests.platforms.pico.closed_loop.recording import INPUTS, OUTPUTS
from tests.platforms.pico.closed_loop.robot import AXES, Axis

PERIOD_NS = 1_000_000
SUBSCRIPTIONS = {"pan": 0, "tilt": 1}
PWM_TOP = 7499
"""150 MHz / 20 kHz - 1."""


@dataclass(frozen=True)
class Cycle:
    """The results of a cycle: the model's ports, and the duty of each axis at its pins."""

    inputs: tuple[float, ...]
    outputs: tuple[float, ...]
    duties: tuple[float, ...]


def decoder_counts(columns: Mapping[str, Sequence[float]], axis: Axis) -> list[int]:
    """The counts for the positions in a host's trace, without the offsets of resets."""
    positions, resets = columns[f"inputs.position_{axis.name}"], columns[f"outputs.encoder_reset_{axis.name}"]
    counts, origin, level = [], 0, False
    for position, reset in zip(positions, resets, strict=True):
        counts.append(origin + round(position / axis.rad_per_count))
        if reset > 0.5 and not level:
            origin = counts[-1]
        level = reset > 0.5
    return counts


def start(processor: Processor) -> None:
    """Starts control as core 1 does, but without its tick."""
    control = processor.address(f"{processor.target}_control")
    processor.call("epg_control_start", control, processor.address("application"))


def cycles(
    processor: Processor,
    columns: Mapping[str, Sequence[float]],
    around: Callable[[int, Callable[[], object]], object] = lambda number, run: run(),
) -> Iterator[Cycle]:
    """Runs a cycle for each row of a host's trace, with its counts and setpoints; ``around(number, run)`` runs it."""
    control = processor.address(f"{processor.target}_control")
    counts = [decoder_counts(columns, axis) for axis in AXES]
    given = {axis.name: 0.0 for axis in AXES}
    for number in range(len(columns["time"])):
        tick_ns = number * PERIOD_NS
        processor.time_us = tick_ns // 1000
        processor.counts[: len(AXES)] = [axis[number] for axis in counts]
        for name, index in SUBSCRIPTIONS.items():
            value = columns[f"inputs.setpoint_{name}"][number]
            if value != given[name]:
                value_words = struct.unpack("<2I", struct.pack("<d", value))
                stacked = (tick_ns & 0xFFFFFFFF, tick_ns >> 32, 1)
                processor.call("epg_control_receive", control, index, *value_words, stacked=stacked)
                given[name] = value
        words = (control, 0, tick_ns & 0xFFFFFFFF, tick_ns >> 32)
        around(number, partial(processor.call, "epg_control_cycle", *words, stacked=(0,)))
        yield Cycle(
            processor.doubles(f"{processor.target}_inputs", len(INPUTS)),
            processor.doubles(f"{processor.target}_outputs", len(OUTPUTS)),
            tuple(duty(processor, axis) for axis in AXES),
        )


def duty(processor: Processor, axis: Axis) -> float:
    sign = processor.pin(axis.direction_a) - processor.pin(axis.direction_b)
    return sign * processor.level(axis.slice, 0) / (PWM_TOP + 1)
