# SPDX-License-Identifier: Apache-2.0
"""A scenario run by an image in the emulator: the inputs, outputs and motion of each control cycle.

The scenario's setpoints are sent over the console, each at its time since the first tick, so that USB and the console
delay them.  Late in every control period, when the cycle is over, the test reads the model's ports in the firmware's
memory, and the state of the motors.
"""

from __future__ import annotations

import struct
from collections.abc import Collection, Mapping
from dataclasses import dataclass, field
from pathlib import Path

from epg.runs.scenario import Scenario
from tests.doubles.rp2040.emulator import Emulator

from .robot import AXES, PERIOD, connect, first_tick

INPUTS = ("position_pan", "position_tilt", "setpoint_pan", "setpoint_tilt")
OUTPUTS = ("encoder_reset_pan", "encoder_reset_tilt", "pan_logging", "pwm_pan", "pwm_tilt", "tilt_logging")
"""Members of the generated structs, in their order: jiwy_model.h."""
LAST_COUNT = 24
"""Offset of `last_count` in epg_quadrature_encoder_t: quadrature_encoder.h."""
LATE = PERIOD * 9 // 10
"""Time in the period at which a cycle is over and its outputs are in effect."""


@dataclass
class Recording:
    """One value per control cycle of each signal, named as in the host's trace.

    ``counts`` are those of the decoders, which a reset does not change; ``sent`` are the setpoints in their order;
    ``said`` are the console's statistics at the end.
    """

    columns: dict[str, list[float]] = field(default_factory=dict)
    counts: dict[str, list[int]] = field(default_factory=dict)
    sent: list[dict[str, float]] = field(default_factory=list)
    said: str = ""

    def add(self, name: str, value: float) -> None:
        self.columns.setdefault(name, []).append(value)

    @property
    def cycles(self) -> int:
        return len(self.columns["time"])


def record(
    image: Path,
    scenario: Scenario,
    angles: Mapping[str, float],
    *,
    swapped: Collection[str] = (),
    core: int = 1,
    console: int = 0,
) -> Recording:
    """Runs ``image`` through all of ``scenario``; ``angles`` are the first angles of the axes.

    ``core`` handles the ticks; ``console`` is the serial port of the console.
    """
    with Emulator(image, usb={"seed": 3, "phase": 321}) as pico:
        connect(pico, angles, swapped=swapped)
        tick = first_tick(pico, core=core)
        recording = Recording()
        interval = round(float(scenario.interval) * 1000)
        for number in range(round(float(scenario.duration) * 1000)):
            if number > 0:
                pico.run(until=tick + number * PERIOD, cycles=0)
            if number % interval == 0:
                values = {topic: profile.value(number / 1000) for topic, profile in scenario.profiles.items()}
                recording.sent.append(values)
                pico.send(" ".join(f"{topic}={value!r}" for topic, value in values.items()) + "\n", port=console)
            pico.run(until=tick + number * PERIOD + LATE, cycles=0)
            recording.add("time", number / 1000)
            _read_ports(pico, recording)
            _read_motors(pico, recording)
        pico.receive(port=console)
        pico.send("stats\n", port=console)
        recording.said = pico.run_until_text("ok stats", port=console)
        assert pico.call("faults") == []
        return recording


def _read_ports(pico: Emulator, recording: Recording) -> None:
    for direction, names in (("inputs", INPUTS), ("outputs", OUTPUTS)):
        values = struct.unpack(f"<{len(names)}d", pico.read(f"jiwy_{direction}"))
        for name, value in zip(names, values, strict=True):
            recording.add(f"{direction}.{name}", value)


def _read_motors(pico: Emulator, recording: Recording) -> None:
    for axis in AXES:
        state = pico.call("motor_state", name=axis.name)
        recording.add(f"plant.inputs.duty_{axis.name}", state["duty"])
        recording.add(f"plant.outputs.angle_{axis.name}", state["angle"])
        count = pico.word(f"jiwy_encoder_{axis.name}", offset=LAST_COUNT, signed=True)
        recording.counts.setdefault(axis.name, []).append(count)
