# SPDX-License-Identifier: Apache-2.0
"""JIWY's control cycle on the emulated Nucleo-H743ZI, measured in instructions.

The emulated processor has no arithmetic of doubles.  The example's application is therefore built for a processor
without an FPU.  A real board needs fewer instructions: its FPU computes with doubles in one instruction each.
"""

from __future__ import annotations

import struct
from functools import partial
from pathlib import Path
from statistics import mean

import pytest

from tests.doubles.stm32.stm32h743 import Stm32h743
from tests.doubles.toolchain import arm_gcc, skip_if_missing, unicorn, xrce_libraries
from tests.zephyr.workspace import build, c_library, workspace

ENCODERS = (("TIM4", ("D", 12), ("D", 13), 2), ("TIM8", ("C", 6), ("C", 7), 3))
OUTPUTS = {"pwm_pan": 0x34, "pwm_tilt": 0x38}
"""Registers CCR1 and CCR2 of timer 1."""
CYCLES = 200
STEPS = 12_000
"""Period of the PWM in clock cycles: 240 MHz by 20 kHz."""
HOMING = {"pwm_pan": 0.05, "pwm_tilt": 0.06}
"""Duties that the example's controller uses for homing."""
PARTS = {"sample": 44, "read": 48, "model_step": 60, "model_finite": 64, "prepare": 72, "write": 76}
"""Members of epg_application_t (epg/control.h), and their offsets."""
LIMIT = 20_000
"""Instructions of a cycle, the first one with the model's initialisation: 42 us at 480 MHz and one clock each."""


@pytest.fixture(scope="module")
def image() -> Path:
    skip_if_missing(partial(workspace, "nucleo_h743zi"), arm_gcc, c_library, unicorn)
    skip_if_missing(xrce_libraries)
    settings = {"CONFIG_FPU": "n", "CONFIG_FPU_SHARING": "n", **c_library()}
    return build("tests/zephyr/proof/application", "nucleo_h743zi", settings=settings) / "zephyr" / "zephyr.elf"


def cycle(chip: Stm32h743) -> int:
    """Runs a cycle at its tick; returns the number of instructions."""
    now, _ = chip.call("epg_port_time_ns")
    _, instructions = chip.call("epg_control_cycle", chip.symbols["jiwy_control"], 0, now, 0, 0)
    return instructions


def test_the_controller_homes(image: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """It stays enabled, both motors get the duties of homing, and a cycle is short."""
    chip = Stm32h743(image)
    chip.boot()
    chip.milliseconds = False
    for timer, a, b, function in ENCODERS:
        chip.attach(timer, a, b, alternate_function=function)
    chip.call("epg_control_start", chip.symbols["jiwy_control"], chip.symbols["application"])

    taken = []
    for number in range(CYCLES):
        for timer, *_ in ENCODERS:
            chip.move(timer, 1 if number % 7 == 0 else 0)
        taken.append(cycle(chip))
        registers = chip.timers["TIM1"].registers
        assert {name: registers[ccr] for name, ccr in OUTPUTS.items()} == {
            name: duty * STEPS for name, duty in HOMING.items()
        }
    enabled = chip.cpu.mem_read(chip.symbols["jiwy_control"] + 8, 1)[0]
    assert enabled == 1
    assert max(taken) < LIMIT

    parts = {}
    for name, place in PARTS.items():
        (chip.symbols[name],) = struct.unpack("<I", chip.cpu.mem_read(chip.symbols["application"] + place, 4))
        parts[name] = chip.call(name)[1]
    with capsys.disabled():
        print(f"\ninstructions of a cycle: {mean(taken):.0f}, at most {max(taken)}; of its parts: {parts}")
