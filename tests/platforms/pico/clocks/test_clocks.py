# SPDX-License-Identifier: Apache-2.0
"""Targets with other clocks than the SDK's defaults: periods and frequencies are right, and a wrong clock is refused.

The emulator counts cycles of clk_sys, so that a period of 1 ms has as many cycles as the clock has kHz.
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path

import pytest

from tests.doubles.rp2040.build import build
from tests.doubles.rp2040.emulator import Emulator
from tests.platforms.pico.images import skip_unless_emulated

OK, WRONG_CLOCK = 0, 2
"""The values of EPG_PICO_OK and EPG_PICO_ERROR_CLOCK."""
MOTOR_SLICE, TICK_SLICE = 1, 7


def image(name: str) -> Path:
    skip_unless_emulated("bare_metal")
    return build("tests/platforms/pico/clocks/project", targets=[name]) / f"{name}.elf"


@pytest.fixture
def user() -> Iterator[Emulator]:
    with Emulator(image("user"), clock=133_000_000) as pico:
        pico.run_until("main", core=0)
        yield pico
        assert pico.call("faults") == []


def start(pico: Emulator, **variables: int) -> int:
    for name, value in variables.items():
        pico.write_word(name, value)
    pico.write_word("order", 1)
    pico.run(cycles=133_000 * 20)
    return pico.word("started")


def reason(pico: Emulator) -> tuple[int, str, int, int]:
    """The error of the start, and its `epg_mcu_clock_t`: name, expected and found frequency in Hz."""
    name, expected, found = (pico.word("wrong_clock_found", offset=4 * n) for n in range(3))
    text = pico.read(name, 16).partition(b"\0")[0].decode() if name else ""
    return pico.word("status"), text, expected, found


def periods(pico: Emulator, cycles: int) -> dict[int, set[int]]:
    """The times between wraps by PWM slice, in cycles of clk_sys, while the emulator runs for ``cycles``."""
    slices = (MOTOR_SLICE, TICK_SLICE)
    pico.call("watch_pwm", slices=slices, wraps=True)
    pico.run(cycles=cycles)
    wraps = pico.call("take", log="pwm")
    at = {slice: [entry[0] for entry in wraps if entry[1] == slice] for slice in slices}
    return {slice: {b - a for a, b in pairwise(times)} for slice, times in at.items()}


def test_a_program_of_epg_s_runs_at_150_mhz() -> None:
    with Emulator(image("built_firmware"), clock=150_000_000) as pico:
        state = pico.run(cycles=150_000 * 30)
        assert state["clk_sys"] == 150_000_000
        assert periods(pico, 150_000 * 5) == {MOTOR_SLICE: {150_000_000 // 20_000}, TICK_SLICE: {150_000}}
        assert pico.call("faults") == [] and state["resets"] == []


def test_a_program_sets_the_clocks_of_its_target(user: Emulator) -> None:
    """133 MHz by set_sys_clock_khz(), which also makes clk_peri 48 MHz: the `.tcf` has both."""
    assert start(user, sys_khz=133_000) == 1
    assert reason(user) == (OK, "", 0, 0)
    assert periods(user, 133_000 * 5) == {MOTOR_SLICE: {133_000_000 // 20_000}, TICK_SLICE: {133_000}}
    assert user.call("uart", uart=0)["baud"] == pytest.approx(115_200, rel=0.001)


@pytest.mark.parametrize(
    ("variables", "clock", "expected", "found"),
    [
        ({}, "clk_sys", 133_000_000, 125_000_000),
        ({"sys_khz": 150_000}, "clk_sys", 133_000_000, 150_000_000),
        ({"sys_khz": 133_000, "peri_as_sys": 1}, "clk_peri", 48_000_000, 133_000_000),
    ],
)
def test_a_wrong_clock_is_refused_with_its_name(
    user: Emulator, variables: dict[str, int], clock: str, expected: int, found: int
) -> None:
    assert start(user, **variables) == 0
    assert reason(user) == (WRONG_CLOCK, clock, expected, found)
    assert not user.call("uart", uart=0)["enabled"], "nothing has been started"
    assert start(user, sys_khz=133_000, peri_as_sys=0) == 1, "the program can correct its clocks"
    assert reason(user) == (OK, "", 0, 0)
