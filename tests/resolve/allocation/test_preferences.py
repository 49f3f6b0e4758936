# SPDX-License-Identifier: Apache-2.0
"""Choices between places that are all possible: counters with more bits, and a timer that starts others in hardware."""

from __future__ import annotations

import re
from pathlib import Path

import hardware_of_text as hardware
import pytest

from epg.generator.catalog.catalog import load_catalog
from epg.generator.data import targets_roots
from epg.generator.diagnostics import Diagnostics

TARGETS = Path(__file__).with_name("targets")
ROOT = Path(__file__).resolve().parents[3]
PWM = "pwm%d: {kind: pwm, frequency: 20 kHz, pins: {value: %s}}"
ENCODER = "encoder%d: {kind: quadrature_encoder, counts_per_revolution: 100, pins: {a: %s, b: %s}}"


def test_an_encoder_gets_the_counter_with_more_bits_if_it_is_free(tmp_path: Path) -> None:
    """PA0 and PA1 are pins of TIM1, which has 16 bits, and of TIM2, which has 32."""
    alone = hardware.allocate_components(
        tmp_path, "timer_board_loop", [ENCODER % (0, "PA0", "PA1")], user_roots=[TARGETS]
    )
    assert alone.resources() == {"encoder0.encoder": "timer TIM2"}
    lines = [ENCODER % (0, "PA0", "PA1"), ENCODER % (1, "PB0", "PB1")]
    both = hardware.allocate_components(tmp_path, "timer_board_loop", lines, user_roots=[TARGETS])
    assert both.resources() == {"encoder0.encoder": "timer TIM1", "encoder1.encoder": "timer TIM2"}


@pytest.mark.parametrize(
    ("pins", "tick", "starts"),
    [
        (["PE9", "PE11"], "TIM15", ["started by TIM15"] * 2),
        (["PE9", "PC8"], "TIM4", ["started by TIM4"] * 2),  # TIM1 and TIM8
        (["PB6", "PC6"], "TIM2", ["started by TIM2"] * 2),  # TIM4 and TIM8
        (["PE5"], "TIM3", ["started by TIM3"]),  # TIM15
        (["PF6"], "TIM6", ["counter preset, within 0.2 us and one count"]),  # nothing triggers TIM16
        (["PF6", "PE9"], "TIM15", ["counter preset, within 0.2 us and one count", "started by TIM15"]),
    ],
)
@pytest.mark.parametrize("platform", ["bare_metal", "freertos"])
def test_the_loops_timer_starts_the_outputs_in_hardware(
    tmp_path: Path, platform: str, pins: list[str], tick: str, starts: list[str]
) -> None:
    lines = [PWM % (n, pin) for n, pin in enumerate(pins)]
    outcome = hardware.allocate_components(tmp_path, f"nucleo_h743zi_{platform}", lines, middleware="none")
    assert outcome.resources()["tick"] == f"timer {tick}"
    assert outcome.assignments is not None
    assert [outcome.assignments[f"pwm{n}", "pwm"].start for n in range(len(pins))] == starts


def test_the_loop_takes_no_timer_of_another_claim(tmp_path: Path) -> None:
    """PE5 needs TIM15, PA0 and PA1 take TIM2 or TIM5, PD12 and PD13 TIM4: TIM3 is left of those that start TIM1."""
    lines = [PWM % (0, "PE9"), PWM % (1, "PE5"), ENCODER % (0, "PA15", "PB3"), ENCODER % (1, "PD12", "PD13")]
    outcome = hardware.allocate_components(tmp_path, "nucleo_h743zi_bare_metal", lines, middleware="none")
    assert outcome.resources()["tick"] == "timer TIM3"


def test_zephyr_keeps_its_timer(tmp_path: Path) -> None:
    """Its driver starts the outputs."""
    outcome = hardware.allocate_components(tmp_path, "nucleo_h743zi_zephyr", [PWM % (0, "PE9")])
    assert outcome.resources()["tick"] == "timer TIM6"
    assert outcome.assignments is not None and outcome.assignments["pwm0", "pwm"].start == ""


def test_the_drivers_table_of_triggers_is_that_of_the_chip() -> None:
    source = (ROOT / "targets" / "families" / "stm32" / "src" / "h7" / "timers.c").read_text(encoding="utf-8")
    rows = re.findall(r"\[(\d+)\] = \{APB\d\(\1\)(.*?)\},\n", source, re.DOTALL)
    target = load_catalog(targets_roots(), Diagnostics()).find_target("nucleo_h743zi_bare_metal")
    assert target is not None
    timer = target.soc.peripherals["timer"]
    names = timer.instances
    triggers = {names[n]: {names[master] for master in found} for n, found in timer.triggered_by.items()}
    masters = {f"TIM{number}": re.search(r"\.masters = \{([\d, ]+)\}", rest) for number, rest in rows}
    assert {name: {f"TIM{n}" for n in found[1].split(", ")} for name, found in masters.items() if found} == triggers
    wide = {f"TIM{number}" for number, rest in rows if "has_32_bits" in rest}
    encoders = target.soc.classes["quadrature"].instances
    assert wide == {name for name in encoders if timer.bits[names.index(name)] == 32}
