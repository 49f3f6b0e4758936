# SPDX-License-Identifier: Apache-2.0
"""The pins that one signal can have, and why others do not fit: the same answers as those of the check of a build."""

from __future__ import annotations

from fractions import Fraction
from pathlib import Path

import pytest

from epg.generator.catalog.catalog import load_catalog
from epg.generator.check.configuration import Configuration
from epg.generator.data import targets_roots
from epg.generator.diagnostics import Diagnostics
from epg.generator.project import Request, load_configuration
from epg.generator.resolve.first_fit import ClaimSignal, with_pins
from epg.generator.resolve.pin_options import STATES, PinOption, pin_options
from epg.generator.resolve.resolve import allocate_claims

PERIOD = Fraction(1, 1000)
CATALOG = load_catalog(targets_roots([]), Diagnostics())


def configuration(name: str) -> Configuration:
    found = load_configuration(Request("robot", name, Path(), Path()), CATALOG, Diagnostics(), pins_required=False)
    assert found is not None
    return found


def options(found: Configuration, signal: ClaimSignal) -> dict[str, PinOption]:
    return {option.pin: option for option in pin_options(found, PERIOD, signal)}


def robot(tmp_path: Path, target: str, *lines: str) -> Configuration:
    path = tmp_path / "robot.tcf"
    components = "".join(f"  {line}\n" for line in lines)
    text = f"version: 1\ntarget: {target}\nnode: me\ncommunication: {{middleware: none}}\ncomponents:\n{components}"
    path.write_text(text, encoding="utf-8")
    return configuration(str(path))


@pytest.mark.parametrize("signal", [("pwm_pan", "value"), ("pwm_tilt", "direction_b"), ("encoder_pan", "b")])
@pytest.mark.parametrize("name", ["rpi_pico_bare_metal_jiwy", "nucleo_h743zi_freertos_jiwy"])
def test_a_pin_fits_exactly_if_a_build_accepts_it(name: str, signal: ClaimSignal) -> None:
    found = configuration(name)
    all_options = options(found, signal)
    board = found.target.board
    assert all_options.keys() == {*board.pins, *board.onboard, *board.reserved}
    for option in all_options.values():
        assert option.state in STATES
        written = {signal: board.pin_title(option.pin), **option.changes}
        accepted = allocate_claims(with_pins(found, written), found, PERIOD, Diagnostics()) is not None
        assert accepted == (option.state in ("fits", "current")), option
        assert option.reason or option.state == "fits"
        assert (signal in option.changes) == (option.state == "fits")


def test_the_reasons(tmp_path: Path) -> None:
    fast, slow = "fast: {kind: pwm, frequency: 20 kHz, pins: {value: 2}}", "slow: {kind: pwm, frequency: 50 Hz}"
    found = options(robot(tmp_path, "rpi_pico_bare_metal", fast, slow), ("slow", "value"))
    assert found["2"].state == "used" and found["2"].user == ("fast", "value")
    assert found["2"].reason == "fast value uses it"
    assert found["3"].state == "unfit"
    assert found["3"].reason == (
        "'fast' and 'slow' share PWM slice 1, which has only one frequency, not 20 kHz and 50 Hz"
    )
    assert found["23"].state == "reserved"
    assert found["25"].state == "fits" and found["25"].reason == "the LED on the board"
    assert dict(found["4"].changes) == {("slow", "value"): "GP4"}


def test_a_pin_of_the_console_is_told(tmp_path: Path) -> None:
    lamp = "lamp: {kind: digital_output}"
    assert options(robot(tmp_path, "rpi_pico_zephyr", lamp), ("lamp", "value"))["0"].reason == (
        "the console of Zephyr uses it now, and would be off"
    )
    assert options(robot(tmp_path, "rpi_pico_bare_metal", lamp), ("lamp", "value"))["0"].reason == ""


def test_the_other_signals_of_an_encoder_follow(tmp_path: Path) -> None:
    encoder = "encoder: {kind: quadrature_encoder, counts_per_revolution: 100, pins: {a: 6, b: 7}}"
    found = options(robot(tmp_path, "rpi_pico_bare_metal", encoder), ("encoder", "a"))
    assert found["6"].state == "current"
    assert dict(found["8"].changes) == {("encoder", "a"): "GP8"}  # B stays beside it
    assert dict(found["20"].changes) == {("encoder", "a"): "GP20", ("encoder", "b"): "GP21"}
    assert found["20"].reason == "b moves to GP21"
    assert found["7"].changes["encoder", "b"] != "GP7"


def test_conflicts_of_other_components_do_not_change_the_answers(tmp_path: Path) -> None:
    lines = ["one: {kind: digital_output, pins: {value: 2}}", "two: {kind: digital_output, pins: {value: 2}}"]
    wrong = robot(tmp_path, "rpi_pico_bare_metal", *lines, "three: {kind: digital_output, pins: {value: 5}}")
    found = options(wrong, ("three", "value"))
    assert found["2"].state == "used" and found["5"].state == "current" and found["6"].state == "fits"


def test_unknown_signals_have_no_pins(tmp_path: Path) -> None:
    found = robot(tmp_path, "rpi_pico_bare_metal", "one: {kind: digital_output, pins: {value: 2}}")
    assert pin_options(found, PERIOD, ("two", "value")) == pin_options(found, PERIOD, ("one", "other")) == ()
