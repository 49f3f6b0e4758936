# SPDX-License-Identifier: Apache-2.0
"""Proposals of pins: the check of a build accepts them, and they are the same in every run."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from pathlib import Path

import pytest

from epg.generator.catalog.catalog import load_catalog
from epg.generator.check.configuration import Configuration
from epg.generator.check.other_code import OtherUse
from epg.generator.data import targets_roots
from epg.generator.diagnostics import Diagnostics
from epg.generator.project import Request, load_configuration
from epg.generator.resolve.allocation import Assignments
from epg.generator.resolve.first_fit import ClaimSignal, first_fit, signals_of, usable_pin, with_pins
from epg.generator.resolve.resolve import allocate_claims
from epg.generator.source import Span
from tests.waiting import calls

BOARDS = ("rpi_pico", "rpi_pico2", "rpi_pico_w", "rpi_pico2_w", "nucleo_h743zi", "nucleo_h743zi2", "nucleo_f767zi")
PERIOD = Fraction(1, 1000)
CATALOG = load_catalog(targets_roots([]), Diagnostics())
THREE_AXES = [
    line
    for axis in ("x", "y", "z")
    for line in (
        f"encoder_{axis}: {{kind: quadrature_encoder, counts_per_revolution: 4096}}",
        f"motor_{axis}: {{kind: pwm_h_bridge, frequency: 20 kHz}}",
        f"end_{axis}: {{kind: digital_input}}",
    )
]


def configuration(tmp_path: Path, target: str, lines: list[str]) -> Configuration:
    path = tmp_path / "robot.tcf"
    components = "".join(f"  {line}\n" for line in lines)
    text = f"version: 1\ntarget: {target}\nnode: me\ncommunication: {{middleware: none}}\ncomponents:\n{components}"
    path.write_text(text, encoding="utf-8")
    diagnostics = Diagnostics()
    request = Request("robot", str(path), Path(), Path())
    found = load_configuration(request, CATALOG, diagnostics, pins_required=False)
    assert found is not None, [problem.message for problem in diagnostics]
    return found


def allocated(found: Configuration, pins: dict[ClaimSignal, str]) -> Assignments:
    diagnostics = Diagnostics()
    result = allocate_claims(with_pins(found, pins), found, PERIOD, diagnostics)
    assert result is not None, [problem.message for problem in diagnostics]
    return result


@pytest.mark.parametrize("platform", ["bare_metal", "zephyr"])
@pytest.mark.parametrize("board", BOARDS)
def test_a_robot_without_pins_gets_pins_that_a_build_accepts(tmp_path: Path, board: str, platform: str) -> None:
    found = configuration(tmp_path, f"{board}_{platform}", THREE_AXES)
    assert set(signals_of(found).values()) == {""}
    pins, count = calls(lambda: first_fit(found, PERIOD))
    assert count < 200_000
    assert pins is not None and pins.keys() == signals_of(found).keys()
    assert len(set(pins.values())) == 3 * 6
    assert all(usable_pin(found.target, pin) for pin in pins.values())
    names = [found.target.board.pin_name(pin) for pin in pins.values()]
    assert not set(names) & {*found.target.board.onboard, *found.target.board.devicetree[found.target.board.console]}
    allocated(found, pins)
    assert list(first_fit(found, PERIOD).items()) == list(pins.items())  # type: ignore[union-attr]


def test_the_first_pins_of_a_pico(tmp_path: Path) -> None:
    """GP0 and GP1 are Zephyr's console, so that they are the last choice.  A and B of an encoder are adjacent."""
    lines = ["encoder: {kind: quadrature_encoder, counts_per_revolution: 4096}", "motor: {kind: pwm_h_bridge}"]
    assert first_fit(configuration(tmp_path, "rpi_pico_bare_metal", lines), PERIOD) == {
        ("encoder", "a"): "GP2",
        ("encoder", "b"): "GP3",
        ("motor", "value"): "GP4",
        ("motor", "direction_a"): "GP5",
        ("motor", "direction_b"): "GP6",
    }


def test_only_the_wanted_signals_get_other_pins(tmp_path: Path) -> None:
    lines = [
        "motor: {kind: pwm_h_bridge, pins: {value: 2, direction_a: 3, direction_b: 4}}",
        "encoder: {kind: quadrature_encoder, counts_per_revolution: 100, pins: {a: 6, b: 7}}",
    ]
    found = configuration(tmp_path, "rpi_pico_bare_metal", lines)
    assert first_fit(found, PERIOD) == {}
    assert first_fit(found, PERIOD, [("motor", "direction_b")]) == {("motor", "direction_b"): "GP4"}
    one = first_fit(found, PERIOD, [("encoder", "b")], {("encoder", "a"): "GP20"})
    assert one == {("encoder", "b"): "GP21"}
    assert first_fit(found, PERIOD, [("encoder", "b")], {("encoder", "a"): "GP3"}) is None  # GP2 and GP4 are used


def test_a_pwm_of_another_frequency_gets_another_slice(tmp_path: Path) -> None:
    lines = ["fast: {kind: pwm, frequency: 20 kHz, pins: {value: 2}}", "slow: {kind: pwm, frequency: 50 Hz}"]
    assert first_fit(configuration(tmp_path, "rpi_pico_bare_metal", lines), PERIOD) == {("slow", "value"): "GP4"}
    same = [lines[0], lines[1].replace("50 Hz", "20 kHz")]
    assert first_fit(configuration(tmp_path, "rpi_pico_bare_metal", same), PERIOD) == {("slow", "value"): "GP3"}


def test_encoders_and_outputs_share_the_timers(tmp_path: Path) -> None:
    """Five encoders leave one timer with four channels; two frequencies need two timers."""
    encoders = [f"e{n}: {{kind: quadrature_encoder, counts_per_revolution: 100}}" for n in range(5)]
    outputs = ["pwm_a: {kind: pwm, frequency: 20 kHz}", "pwm_b: {kind: pwm, frequency: 50 Hz}"]
    found = configuration(tmp_path, "nucleo_h743zi_bare_metal", outputs + encoders)
    pins = first_fit(found, PERIOD)
    assert pins is not None
    allocated(found, pins)


def test_too_many_claims_are_refused_quickly(tmp_path: Path) -> None:
    lines = [f"e{n}: {{kind: quadrature_encoder, counts_per_revolution: 100}}" for n in range(7)]
    found = configuration(tmp_path, "nucleo_h743zi_bare_metal", lines)
    pins, count = calls(lambda: first_fit(found, PERIOD))
    assert pins is None and count < 200_000
    many = configuration(tmp_path, "rpi_pico_bare_metal", [f"out{n}: {{kind: digital_output}}" for n in range(27)])
    assert first_fit(many, PERIOD) is None


def test_pins_and_timers_of_other_code_stay_free(tmp_path: Path) -> None:
    found = configuration(tmp_path, "nucleo_h743zi_bare_metal", [THREE_AXES[0], "out: {kind: digital_output}"])
    first = first_fit(found, PERIOD)
    assert first is not None
    use = OtherUse("", Span("robot.ioc"))
    hardware = allocated(found, first)
    timer = hardware["encoder_x", "encoder"].instance_name
    taken = found.target.board.pin_name(first["out", "value"])
    other = replace(found, others=replace(found.others, pins={taken: use}, instances={timer: use}))
    second = first_fit(other, PERIOD)
    assert second is not None and second["out", "value"] != first["out", "value"]
    assert allocated(other, second)["encoder_x", "encoder"].instance_name != timer


def test_a_conflict_of_other_components_does_not_matter(tmp_path: Path) -> None:
    lines = ["one: {kind: digital_output, pins: {value: 2}}", "two: {kind: digital_output, pins: {value: 2}}"]
    found = configuration(tmp_path, "rpi_pico_bare_metal", [*lines, "three: {kind: digital_output}"])
    assert first_fit(found, PERIOD) == {("three", "value"): "GP3"}
    assert first_fit(found, PERIOD, [("two", "value")]) == {("two", "value"): "GP3"}


def test_targets_without_pins_need_no_proposal(tmp_path: Path) -> None:
    found = configuration(tmp_path, "host", THREE_AXES)
    assert signals_of(found) == {} and first_fit(found, PERIOD) == {}
