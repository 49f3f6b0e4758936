# SPDX-License-Identifier: Apache-2.0
"""The example's application for a Nucleo-H743ZI on an emulated chip: the registers that its port layer uses.

The emulated processor has no arithmetic of doubles and no switch of threads: test_h743_cycle.py runs the controller.
"""

from __future__ import annotations

import struct
from functools import partial
from pathlib import Path

import pytest

from tests.doubles.stm32.stm32h743 import Stm32h743
from tests.doubles.toolchain import arm_gcc, skip_if_missing, unicorn, xrce_libraries
from tests.zephyr.workspace import build, c_library, workspace

ENCODERS = {"encoder_pan": ("TIM4", ("D", 12), ("D", 13), 2), "encoder_tilt": ("TIM8", ("C", 6), ("C", 7), 3)}
OUTPUTS = {"pwm_pan": 0x34, "pwm_tilt": 0x38}
"""Registers CCR1 and CCR2 of timer 1."""
ARR = 0x2C
READ, WRITE = 400, 700
"""Largest number of instructions for a read of a decoder, and for a write of a duty."""


@pytest.fixture(scope="module")
def image() -> Path:
    skip_if_missing(partial(workspace, "nucleo_h743zi"), arm_gcc, c_library, unicorn)
    skip_if_missing(xrce_libraries)
    return build("examples/zephyr_jiwy/app", "nucleo_h743zi", settings=c_library()) / "zephyr" / "zephyr.elf"


@pytest.fixture(scope="module")
def chip(image: Path) -> Stm32h743:
    made = Stm32h743(image)
    made.boot()
    for timer, a, b, function in ENCODERS.values():
        made.attach(timer, a, b, alternate_function=function)
    return made


def count(chip: Stm32h743, encoder: str) -> int:
    value, instructions = chip.call("epg_port_quadrature_count", chip.symbols[f"jiwy_{encoder}_config"])
    assert instructions < READ
    return struct.unpack("<i", struct.pack("<I", value))[0]


@pytest.mark.parametrize("encoder", ENCODERS)
def test_decoders_count_over_wraps(chip: Stm32h743, encoder: str) -> None:
    """Both directions, over many ranges of 16 bits without a read; the other decoder does not change."""
    (other,) = ENCODERS.keys() - {encoder}
    begin, still = count(chip, encoder), count(chip, other)
    true = 0
    for edges in (1, 70_000, -1, -400_000, 1_000_003, -700_000):
        chip.move(ENCODERS[encoder][0], edges)
        true += edges
        assert count(chip, encoder) - begin == true
        assert count(chip, other) == still
    assert chip.interrupts > 50


@pytest.mark.parametrize("output", OUTPUTS)
def test_compare_registers_have_the_level(chip: Stm32h743, output: str) -> None:
    """A level is a part of top + 1, and the period is that of 20 kHz; the other output's register does not change."""
    config = chip.symbols[f"jiwy_{output}_config"]
    (other,) = OUTPUTS.keys() - {output}
    chip.call("epg_port_pwm_start", config)
    registers = chip.timers["TIM1"].registers
    before = registers.get(OUTPUTS[other], 0)
    steps = registers[ARR] + 1
    for level in (0, 1, steps // 3, steps - 1, steps):
        _, instructions = chip.call("epg_port_pwm_write", config, level)
        assert registers[OUTPUTS[output]] == level
        assert registers[ARR] + 1 == steps
        assert registers.get(OUTPUTS[other], 0) == before
        assert instructions < WRITE
