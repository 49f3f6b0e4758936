# SPDX-License-Identifier: Apache-2.0
"""Stacks of the images for a Nucleo-H743ZI: the largest use that the machine code permits, and the use of a run."""

from __future__ import annotations

import re
import struct
from pathlib import Path

import pytest

from tests.doubles.toolchain import ROOT
from tests.platforms.stm32.console import ask, start
from tests.platforms.stm32.images import PLATFORMS, images
from tests.platforms.stm32.stack_bound import bound, functions

FRAME = 0x68 + 8
"""An exception frame with the registers of the FPU, and its alignment (Armv7-M ARM, B1.5.6)."""
PANIC = ("epg_one_core_panic",)
"""Ends the run, on the stack for faults."""
CYCLE = (
    "sample", "read_sources", "inputs_finite", "model_init", "model_step", "model_finite", "model_stopped",
    "prepare_actuators", "write_actuators", "make_safe", "monitor",
)  # fmt: skip
SOURCE = ROOT / "targets" / "mcu" / "one_core" / "src" / "control.c"


def control_stack(elf: Path) -> tuple[int, list[str]]:
    """The bound of the control cycle's stack, and the calls that lead to it."""
    known = functions(elf)
    jog = [name for name in known if re.search(r"_jog_duty$|_encoder_\w+_(count|position)$", name)]
    observed = [name for name in known if re.search(r"_jog_duty_applied$|_encoder_\w+_position$", name)]
    measured = [name for name in known if name.startswith("measured_")]
    dynamic = [name for name in known if "RELbot_Control16CalculateDynamicEv" in name]
    pointers = {
        "epg_one_core_on_tick": ["make_safe", *(n for n in ("epg_family_service_pend",) if n in known)],
        "epg_control_cycle": [name for name in CYCLE if name in known],
        "epg_setpoints_update": measured,
        "epg_parameters_restore": ["set_parameters"],
        "epg_parameters_apply": ["set_parameters"],
        "epg_jog_cycle": jog,
        "epg_jog_observe": observed,
    }
    steps = [name for name in known if "RungeKutta44StepEv" in name]
    assert bool(steps) == bool(dynamic)
    pointers |= dict.fromkeys(steps, dynamic)  # a virtual function of the model in C++
    most, path = bound(elf, "epg_one_core_on_tick", pointers, without=PANIC)
    return most, list(path)


def control_stack_size() -> int:
    found = re.search(r"#define EPG_ONE_CORE_CONTROL_STACK_SIZE (\d+)", SOURCE.read_text(encoding="utf-8"))
    assert found is not None
    return int(found[1])


@pytest.mark.parametrize("name", ["jiwy", "fast", "relbot"])
@pytest.mark.parametrize("middleware", ["console", "xrce"])
@pytest.mark.parametrize("platform", PLATFORMS)
def test_the_control_cycle_cannot_use_its_whole_stack(platform: str, middleware: str, name: str) -> None:
    """A quarter of its use is left for models that are larger."""
    most, path = control_stack(images(platform, middleware) / f"{name}_firmware.elf")
    assert {"epg_control_cycle", "model_step"} <= set(path) or "model_init" in path, path
    assert most * 5 <= control_stack_size() * 4, path


@pytest.mark.parametrize("platform", PLATFORMS)
def test_a_run_uses_no_more_than_the_bound(platform: str) -> None:
    """Parameters, capture and moving by hand run, too.  The bound is less than twice the use."""
    chip = start(platform)
    for command in ("stats", "set Pan\\PID\\kp=2.5", "disable", "jog pwm_pan 0.1 20", "enable", "stats"):
        assert "error" not in ask(chip, command), command
    chip.run(0.05)
    size = control_stack_size()
    memory = chip.processor.cpu.mem_read(chip.symbols["epg_one_core_control_memory"], size)
    words = struct.unpack(f"<{size // 4}I", memory)
    untouched = next(number for number, word in enumerate(words) if word != words[0])
    used = size - 4 * untouched
    most, path = control_stack(images(platform, "console") / "jiwy_firmware.elf")
    assert 0 < used <= most < 2 * used, path


@pytest.mark.parametrize("platform", PLATFORMS)
def test_interrupts_of_the_control_side_take_little_of_the_main_stack(platform: str) -> None:
    """The tick and TIM7 do not interrupt each other.  _Min_Stack_Size of STM32CubeMX is 1024 bytes."""
    elf = images(platform, "console") / "jiwy_firmware.elf"
    most = max(bound(elf, name, {"on_tick": ()})[0] for name in ("on_wrap", "on_tick"))
    assert most + FRAME <= 256
