# SPDX-License-Identifier: Apache-2.0
"""Hardware of whole targets: the assignments, and that EPG refuses no possible target."""

from __future__ import annotations

import os
import subprocess
import sys
from fractions import Fraction
from pathlib import Path

import hardware_of_text as hardware
import pytest
from hypothesis import given
from hypothesis import strategies as st

from epg.generator.catalog.hardware import Divider
from epg.generator.quantity import show
from epg.generator.resolve.divider import NEAR_ENOUGH, clock_range, divide, neighbours
from tests.waiting import calls

TARGETS = Path(__file__).with_name("targets")
ENCODER = "{kind: quadrature_encoder, counts_per_revolution: 100, pins: {a: %s, b: %s}}"
PWM = "{kind: pwm, frequency: %s, pins: {value: %s}}"


def encoders(count: int) -> list[str]:
    return [f"e{n}: {ENCODER % (2 * n, 2 * n + 1)}" for n in range(count)]


@pytest.mark.parametrize(
    "target", ["rpi_pico_bare_metal", "rpi_pico_freertos", "rpi_pico2_bare_metal", "rpi_pico2_freertos"]
)
def test_jiwy_on_its_boards(target: str) -> None:
    outcome = hardware.allocate_file(f"{target}_jiwy.tcf")
    assert outcome.ids == []
    assert outcome.resources() == {
        "encoder_pan.encoder": "PIO block 0, state machine 0",
        "encoder_tilt.encoder": "PIO block 0, state machine 1",
        "pwm_pan.pwm": "PWM slice 1, channel A",
        "pwm_pan.direction_a": "pin 7",
        "pwm_pan.direction_b": "pin 8",
        "pwm_tilt.pwm": "PWM slice 2, channel A",
        "pwm_tilt.direction_a": "pin 5",
        "pwm_tilt.direction_b": "pin 6",
        "tick": "PWM slice 8" if "pico2" in target else "PWM slice 7",
    }
    clock = 150_000_000 if "pico2" in target else 125_000_000
    settings = {key: found.settings for key, found in outcome.assignments.items() if found.settings}
    clocks = {key: found["prescaler"] * (found["top"] + 1) for key, found in settings.items()}
    assert clocks == {
        ("pwm_pan", "pwm"): clock // 20_000,
        ("pwm_tilt", "pwm"): clock // 20_000,
        ("", "tick"): clock // 1000,
    }
    pan = outcome.assignments["pwm_pan", "pwm"]
    assert (pan.pins, pan.instance, pan.slot) == ({"value": 2}, 1, 0)


@pytest.mark.parametrize("name", ["host_jiwy.tcf", "host_relbot.tcf"])
def test_the_host_numbers_everything_itself(name: str) -> None:
    outcome = hardware.allocate_file(name)
    assert outcome.ids == []
    pins = [pin for found in outcome.assignments.values() for pin in found.pins.values()]
    assert pins == list(range(10))
    assert not any(found.pins_are_real for found in outcome.assignments.values())
    for claim in ("encoder", "pwm"):
        slots = [found.slot for (_, name), found in outcome.assignments.items() if name == claim]
        assert slots == [0, 1]
    top = {found.settings["top"] for found in outcome.assignments.values() if found.settings}
    assert top == {6249}  # the number of steps on a Pico


def test_the_host_ignores_pins(tmp_path: Path) -> None:
    """The same file as for a board, with more encoders than any board supports."""
    outcome = hardware.allocate_components(tmp_path, "host", [*encoders(40), f"p: {PWM % ('20 kHz', 0)}"])
    assert outcome.ids == []
    assert sorted(found.slot for (_, c), found in outcome.assignments.items() if c == "encoder") == list(range(40))


def test_the_host_ends_where_the_port_layer_cannot_count(tmp_path: Path) -> None:
    lines = [f"d{n}: {{kind: digital_output}}" for n in range(257)]
    assert hardware.allocate_components(tmp_path, "host", lines[:256]).ids == []
    assert hardware.allocate_components(tmp_path, "host", lines).ids == ["too-many"]


def test_nine_encoders_are_one_too_many_for_a_pico(tmp_path: Path) -> None:
    assert hardware.allocate_components(tmp_path, "rpi_pico_freertos", encoders(8)).ids == []
    outcome = hardware.allocate_components(tmp_path, "rpi_pico_freertos", encoders(9))
    assert outcome.ids == ["too-many"]
    assert outcome.assignments is None
    assert hardware.allocate_components(tmp_path, "rpi_pico2_freertos", encoders(11)).ids == []


def test_the_loop_takes_the_one_slice_that_is_left(tmp_path: Path) -> None:
    for free in range(8):
        lines = [f"p{n}: {PWM % ('20 kHz', 2 * n)}" for n in range(8) if n != free]
        outcome = hardware.allocate_components(tmp_path, "rpi_pico_bare_metal", lines)
        assert outcome.resources()["tick"] == f"PWM slice {free}"
    full = [f"p{n}: {PWM % ('20 kHz', 2 * n)}" for n in range(8)]
    assert hardware.allocate_components(tmp_path, "rpi_pico_bare_metal", full).ids == ["too-many"]
    assert hardware.allocate_components(tmp_path, "rpi_pico2_bare_metal", full).resources()["tick"] == "PWM slice 8"


def test_both_channels_of_a_slice_with_one_frequency(tmp_path: Path) -> None:
    lines = [f"p: {PWM % ('20 kHz', 2)}", f"q: {PWM % ('20000 Hz', 3)}"]
    outcome = hardware.allocate_components(tmp_path, "rpi_pico_bare_metal", lines)
    assert outcome.resources()["q.pwm"] == "PWM slice 1, channel B"


def test_every_pin_that_a_pico_has_out_makes_pwm(tmp_path: Path) -> None:
    """Against the formula of the data sheets (RP2040 4.5.2, RP2350 12.5.2): slice (n / 2) mod 8, channel n mod 2."""
    for target in ("rpi_pico_bare_metal", "rpi_pico2_bare_metal"):
        for pin in [*range(23), 25, *range(26, 29)]:
            outcome = hardware.allocate_components(tmp_path, target, [f"p: {PWM % ('20 kHz', pin)}"])
            found = outcome.assignments["p", "pwm"]
            assert (found.instance, found.slot) == (pin // 2 % 8, pin % 2)


def test_pins_by_other_names(tmp_path: Path) -> None:
    outcome = hardware.allocate_components(
        tmp_path, "rpi_pico_bare_metal", [f"p: {PWM % ('1 kHz', 'LED')}", f"e: {ENCODER % ('GP4', 'GPIO5')}"]
    )
    assert outcome.assignments["p", "pwm"].pins == {"value": 25}
    assert outcome.assignments["e", "encoder"].pins == {"a": 4, "b": 5}


@pytest.mark.parametrize(
    "lines",
    [
        # The encoder could use TIM1 or TIM2, the outputs only TIM1: the encoder must not take TIM1
        [f"e: {ENCODER % ('PA0', 'PA1')}", f"p: {PWM % ('20 kHz', 'PA2')}", f"q: {PWM % ('20 kHz', 'PA3')}"],
        # PA0 could use both timers, but its frequency differs from that of the others
        [f"p: {PWM % ('20 kHz', 'PA0')}", f"q: {PWM % ('10 kHz', 'PA3')}", f"r: {PWM % ('20 kHz', 'PB1')}"],
        [f"p: {PWM % ('20 kHz', 'PA0')}", f"q: {PWM % ('20 kHz', 'PA3')}", f"e: {ENCODER % ('PB0', 'PB1')}"],
    ],
)
def test_legal_wirings_that_a_first_choice_would_refuse(tmp_path: Path, lines: list[str]) -> None:
    """A possible assignment is found for every order of the components."""
    for order in (lines, lines[::-1], [*lines[1:], lines[0]]):
        outcome = hardware.allocate_components(tmp_path, "timer_board_loop", order, user_roots=[TARGETS])
        assert outcome.ids == []


def test_named_instances_and_pins(tmp_path: Path) -> None:
    lines = [f"e: {ENCODER % ('PA0', 'PA1')}", f"p: {PWM % ('20 kHz', 'PA2')}"]
    outcome = hardware.allocate_components(tmp_path, "timer_board_loop", lines, user_roots=[TARGETS])
    assert outcome.resources() == {"e.encoder": "timer TIM2", "p.pwm": "timer TIM1, channel CH1"}
    assert outcome.assignments["e", "encoder"].pins == {"a": 0, "b": 1}
    assert outcome.assignments["e", "encoder"].instance == 1


@pytest.mark.parametrize(
    ("lines", "id", "message", "hint"),
    [
        (
            [f"p: {PWM % ('20 kHz', 'PA6')}"],
            "pin-cannot-reach",
            "pin PA6 cannot be 'value' of a PWM output: no timer reaches it",
            "free pins for a PWM output: PA0-PA5, PB0, PB1",
        ),
        (
            [f"e: {ENCODER % ('PB0', 'PA3')}"],
            "pin-cannot-reach",
            "no timer reaches pins PB0, PA3 together",
            "for example: PA0 and PA1",
        ),
        (
            [f"p: {PWM % ('20 kHz', 'PB3')}"],
            "pin-unknown",
            "pin PB3 is not broken out on timer_board",
            "pins of timer_board: PA0-PA7, PB0, PB1",
        ),
        (
            [f"p: {PWM % ('20 kHz', 'PB2')}"],
            "pin-reserved",
            "pin PB2 of timer_board is reserved: it selects the boot mode",
            "pins of timer_board: PA0-PA7, PB0, PB1",
        ),
        (
            [f"p: {PWM % ('20 kHz', 'PA4')}", "c: {kind: pulses, pins: {value: PA5}}"],
            "timer-frequency-conflict",
            "'p' and 'c' share timer TIM3, which has only one frequency, not 20 kHz and none",
            "write the same frequency for both, or move 'c' to a free pin: PA0-PA3, PB0, PB1",
        ),
        (
            [f"e: {ENCODER % ('PA0', 'PA1')}", f"p: {PWM % ('1 kHz', 'PA2')}", f"q: {PWM % ('1 kHz', 'PB1')}"],
            "too-many",
            "no timer is free for 'q', which is a PWM output: timer_board_loop has 3 timers with 2 channels each",
            "the other users are 'e', 'p'",
        ),
    ],
)
def test_messages_come_from_the_data(tmp_path: Path, lines: list[str], id: str, message: str, hint: str) -> None:
    """Names of peripherals, slots and pins are those in the chip's description; no Python is needed for the chip."""
    outcome = hardware.allocate_components(tmp_path, "timer_board_loop", lines, user_roots=[TARGETS])
    assert [(p.id, p.message, p.hint) for p in outcome.problems] == [(id, message, hint)]


def test_several_conflicts_are_reported_at_once(tmp_path: Path) -> None:
    lines = [f"{name}: {PWM % (frequency, pin)}" for name, frequency, pin in (("a", "1 kHz", 0), ("b", "2 kHz", 1))]
    lines += [f"{name}: {PWM % (frequency, pin)}" for name, frequency, pin in (("c", "1 kHz", 2), ("d", "2 kHz", 3))]
    outcome = hardware.allocate_components(tmp_path, "rpi_pico_bare_metal", lines)
    assert outcome.ids == ["pwm-frequency-conflict"] * 2


@pytest.mark.parametrize("pull", ["none", "up", "down"])
@pytest.mark.parametrize("target", ["rpi_pico_bare_metal", "rpi_pico2_bare_metal", "rpi_pico2_freertos", "host"])
def test_pull_downs_that_a_chip_has_not(tmp_path: Path, target: str, pull: str) -> None:
    outcome = hardware.allocate_components(
        tmp_path, target, [f"b: {{kind: digital_input, pins: {{value: 3}}, pull: {pull}}}"]
    )
    assert outcome.ids == (["unsupported-value"] if pull == "down" and "pico2" in target else [])


def test_an_unknown_period_still_takes_a_slice(tmp_path: Path) -> None:
    """A board without a slice for the control loop is refused even before the model is known."""
    full = [f"  p{n}: {PWM % ('20 kHz', 2 * n)}" for n in range(8)]
    head = [
        "version: 1",
        "target: rpi_pico_bare_metal",
        "node: robot",
        "control: {enable_at_start: false}",
        "components:",
    ]
    (tmp_path / "robot.tcf").write_text("\n".join([*head, *full, ""]), encoding="utf-8")
    assert hardware.allocate_file("robot.tcf", beside=tmp_path).ids == ["too-many"]


def test_the_same_in_every_run(tmp_path: Path) -> None:
    """Python's string hashes differ from run to run, but the hardware must not."""
    lines = [f"e: {ENCODER % ('PA0', 'PA1')}", f"p: {PWM % ('9 kHz', 'PA5')}", f"q: {PWM % ('9 kHz', 'PA2')}"]
    hardware.allocate_components(tmp_path, "timer_board_loop", lines, user_roots=[TARGETS])
    command = [
        sys.executable,
        hardware.__file__,
        str(tmp_path),
        str(TARGETS),
        "robot.tcf",
        "rpi_pico2_freertos_jiwy.tcf",
    ]
    root = str(Path(__file__).resolve().parents[3])
    results = set()
    for seed in ("1", "2", "3"):
        env = {
            **os.environ,
            "PYTHONHASHSEED": seed,
            "PYTHONPATH": os.pathsep.join([root, os.environ.get("PYTHONPATH", "")]),
        }
        results.add(subprocess.run(command, env=env, capture_output=True, text=True, check=True).stdout)
    assert len(results) == 1
    assert "timer TIM2" in results.pop()


def test_refusing_a_full_board_is_fast(tmp_path: Path) -> None:
    """More encoders and PWM outputs than a Pico has: fewer than half a million calls, with files and messages."""
    lines = [*encoders(11), "x: {kind: pwm, pins: {value: 22}}", "y: {kind: pwm, pins: {value: 26}, frequency: 1 kHz}"]
    lines += ["z: {kind: pwm, pins: {value: 27}, frequency: 3 kHz}"]
    found, count = calls(lambda: hardware.allocate_components(tmp_path, "rpi_pico_bare_metal", lines))
    assert found.ids != [] and count < 500_000


DIVIDER = Divider((1, 255), (2, 65535))


@given(st.fractions(Fraction(2), Fraction(255 * 65535)))
def test_a_division_is_the_nearest_with_the_finest_steps(clocks: Fraction) -> None:
    found = divide(clocks, DIVIDER, exact=False)
    if found is None:
        nearest = min(abs(n - clocks) for n in neighbours(clocks, DIVIDER, exact=False))
        assert nearest > 0
        return
    assert abs(found.clocks - clocks) <= clocks * NEAR_ENOUGH
    assert found.prescaler == 1 or (found.prescaler - 1) * DIVIDER.counter[1] < clocks


@given(st.integers(1, 255), st.integers(2, 65535))
def test_what_divides_exactly_is_found_exactly(prescaler: int, counter: int) -> None:
    found = divide(Fraction(prescaler * counter), DIVIDER, exact=True)
    assert found is not None and found.clocks == prescaler * counter and found.prescaler <= prescaler


def test_no_exact_division_of_a_large_prime() -> None:
    assert divide(Fraction(125_003), DIVIDER, exact=True) is None
    below, above = neighbours(Fraction(125_003), DIVIDER, exact=True)
    assert below < 125_003 < above
    assert all(divide(Fraction(n), DIVIDER, exact=True) for n in (below, above))
    assert clock_range(DIVIDER) == (2, 255 * 65535)


@pytest.mark.parametrize(
    ("value", "dimension", "rounding", "text"),
    [
        (Fraction(20_000), "frequency", 0, "20 kHz"),
        (Fraction(125_000_000), "frequency", 0, "125 MHz"),
        (Fraction(13369344, 10**8), "time", -1, "133.693 ms"),
        (Fraction(13369344, 10**8), "time", 1, "133.694 ms"),
        (Fraction(1, 1000), "time", 0, "1 ms"),
        (Fraction(60), "time", 0, "60 s"),
        (Fraction(16, 10**9), "time", 0, "16 ns"),
        (Fraction(0), "frequency", 0, "0 Hz"),
    ],
)
def test_quantities_for_people(value: Fraction, dimension: str, rounding: int, text: str) -> None:
    assert show(value, dimension, rounding) == text
