# SPDX-License-Identifier: Apache-2.0
"""Writes a project of any size.  Each axis has an encoder, a motor, a setpoint and a published value.

The project's chip grows with the number of axes.  It is similar to an RP2350.  A PWM slice has two channels with a
common frequency, and each channel can use one of two pins; one slice times the control loop.  A PIO block has four
state machines for encoders on adjacent pins.  The controller is written by hand, with a ``model.yaml``.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

KINDS = 4
"""The number of components of one axis."""


@dataclass(frozen=True)
class BigProject:
    """The files of a project.  ``arguments`` are the options of ``epg generate`` for them."""

    folder: Path

    @property
    def targets(self) -> Path:
        return self.folder / "targets"

    @property
    def arguments(self) -> list[str]:
        files = {"tcf": "big.tcf", "model": "model", "bindings": "big.bindings.yaml"}
        return [word for key, file in files.items() for word in (f"--{key}", str(self.folder / file))]


def write_big_project(folder: Path, components: int) -> BigProject:
    """Writes the project with ``components`` components, a multiple of four."""
    assert components % KINDS == 0
    axes = range(components // KINDS)
    files = {
        "big.tcf": _configuration(axes),
        "big.bindings.yaml": _bindings(axes),
        "model/model.yaml": _model(axes),
        "model/big.h": _header(axes),
        "model/big.c": _source(axes),
        "targets/socs/big/soc.yaml": _soc(axes),
        "targets/boards/big/board.yaml": _board(axes),
        "targets/platforms/plain/platform.yaml": _PLATFORM,
        "targets/platforms/plain/platform.cmake": "# Nothing is built for this platform.\n",
    }
    for name, text in files.items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8", newline="\n")
    return BigProject(folder)


def _slices(axes: range) -> int:
    """The number of PWM slices: one for each two motors, and one for the control loop."""
    return (len(axes) + 1) // 2 + 1


def _first_direction(axes: range) -> int:
    return 4 * _slices(axes)


def _first_encoder(axes: range) -> int:
    return _first_direction(axes) + 2 * len(axes)


def _configuration(axes: range) -> str:
    lines = ["version: 1", "target: big_plain", "node: big", "control: {period: 1 ms, enable_at_start: false}"]
    lines += ["communication: {middleware: none, period: 33 ms}", "components:"]
    for axis in axes:
        pwm = axis if axis % 4 < 2 else axis + 2 * _slices(axes)  # use both pairs of pins of the slices
        a, direction = _first_encoder(axes) + 2 * axis, _first_direction(axes) + 2 * axis
        pins = f"value: {pwm}, direction_a: {direction}, direction_b: {direction + 1}"
        frequency = "20 kHz" if axis % 6 < 2 else "25 kHz"
        encoder = f"pins: {{a: {a}, b: {a + 1}}}, counts_per_revolution: 4096, gear: 5625/361"
        lines += [
            f"  encoder_{axis}: {{kind: quadrature_encoder, {encoder}}}",
            f"  motor_{axis}: {{kind: pwm_h_bridge, pins: {{{pins}}}, frequency: {frequency}, max_duty: 0.9}}",
            f"  setpoint_{axis}: {{kind: ros_subscriber, topic: setpoint_{axis}, unit: deg, timeout: 0.5 s}}",
            f"  logging_{axis}: {{kind: ros_publisher, topic: logging_{axis}, unit: rad}}",
        ]
    return "\n".join(lines) + "\n"


def _bindings(axes: range) -> str:
    lines = ["version: 1", "model: big", "inputs:"]
    for axis in axes:
        lines += [f"  position_{axis}: encoder_{axis}", f"  wanted_{axis}: {{from: setpoint_{axis}, limits: [-2, 2]}}"]
    lines.append("outputs:")
    for axis in axes:
        lines += [f"  duty_{axis}: motor_{axis}", f"  angle_{axis}: logging_{axis}"]
    return "\n".join(lines) + "\n"


def _model(axes: range) -> str:
    lines = ["version: 1", "name: big", "step: 1 ms", "header: big.h", "sources: [big.c]", "instance: big_t"]
    lines += ["types: {inputs: big_inputs_t, outputs: big_outputs_t}", "functions: {init: big_init, step: big_step}"]
    lines.append("inputs:")
    for axis in axes:
        lines += [f"  position_{axis}: {{unit: rad}}", f"  wanted_{axis}: {{unit: rad}}"]
    lines.append("outputs:")
    for axis in axes:
        lines += [f"  duty_{axis}: {{}}", f"  angle_{axis}: {{unit: rad}}"]
    return "\n".join(lines) + "\n"


def _header(axes: range) -> str:
    inputs = "".join(f"    double position_{axis};\n    double wanted_{axis};\n" for axis in axes)
    outputs = "".join(f"    double duty_{axis};\n    double angle_{axis};\n" for axis in axes)
    return f"""/* A controller of {len(axes)} axes, written for a benchmark. */
#ifndef BIG_H
#define BIG_H

typedef struct {{
    int steps;
}} big_t;

typedef struct {{
{inputs}}} big_inputs_t;

typedef struct {{
{outputs}}} big_outputs_t;

void big_init(big_t *big, const big_inputs_t *in, big_outputs_t *out);
void big_step(big_t *big, const big_inputs_t *in, big_outputs_t *out);

#endif
"""


def _source(axes: range) -> str:
    lines = [
        f"out->duty_{n} = in->wanted_{n} - in->position_{n};\n    out->angle_{n} = in->position_{n};" for n in axes
    ]
    statements = "".join(f"    {line}\n" for line in lines)
    return f"""#include "big.h"

void big_step(big_t *big, const big_inputs_t *in, big_outputs_t *out)
{{
    big->steps++;
{statements}}}

void big_init(big_t *big, const big_inputs_t *in, big_outputs_t *out)
{{
    big_step(big, in, out);
    big->steps = 0;
}}
"""


def _ranges(last: int) -> str:
    return ", ".join(f"{first}-{min(first + 249, last)}" for first in range(0, last + 1, 250))


def _soc(axes: range) -> str:
    slices = _slices(axes)
    pins = "\n".join(
        f"      {n}: {{A: [{2 * n}, {2 * (n + slices)}], B: [{2 * n + 1}, {2 * (n + slices) + 1}]}}"
        for n in range(slices)
    )
    return f"""api: 1
soc: big
title: chip for {len(axes)} axes
family: big
clocks: {{sys: {{title: clk_sys, frequency: 150 MHz}}}}
pins: [{_ranges(_first_encoder(axes) + 2 * len(axes) - 1)}]
peripherals:
  pwm:
    title: PWM slice
    instances: {slices}
    slots: {{title: channel, names: [A, B]}}
    agree: [frequency]
    divider: {{clock: sys, prescaler: 1-255, counter: 2-65535}}
    pins:
{pins}
  pio:
    title: PIO block
    instances: {(len(axes) + 3) // 4}
    slots: {{title: state machine, count: 4}}
    agree: [program]
classes:
  digital_input: {{title: digital input, signals: {{value: any}}}}
  digital_output: {{title: digital output, signals: {{value: any}}}}
  pwm:
    title: PWM output
    peripheral: pwm
    takes: slot
    signals: {{value: slot}}
    divider: {{from: frequency}}
  periodic_tick:
    title: periodic timer
    peripheral: pwm
    takes: instance
    divider: {{from: period, exact: true}}
  quadrature:
    title: quadrature decoder
    peripheral: pio
    takes: slot
    signals: {{a: any, b: any}}
    neighbours: [a, b]
    fixed: {{program: quadrature decoder}}
"""


def _board(axes: range) -> str:
    pins = _ranges(_first_encoder(axes) + 2 * len(axes) - 1)
    return f"api: 1\nboard: big\nsummary: a chip with enough pins\nsoc: big\npins: [{pins}]\n"


_PLATFORM = """api: 1
platform: plain
summary: no system software
families: [big]
classes: [digital_input, digital_output, pwm, quadrature, periodic_tick]
tick: {class: periodic_tick}
middlewares: {none: []}
builds: true
templates: []
"""
