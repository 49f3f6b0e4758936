# SPDX-License-Identifier: Apache-2.0
"""Pins in a session: the drawing and the list agree, a change is a line of the user's .tcf, conflicts are shown."""

from __future__ import annotations

import re
import shutil
import xml.etree.ElementTree as ElementTree
from pathlib import Path
from typing import Any

import pytest

from epg.connect.body import Refused
from epg.connect.session import Session
from tests.checkout import ROOT
from tests.connect.page import session_of

TCF = "version: 1\nextends: {}.tcf\n"
CMAKE = "epg_add_target(robot TCF robot.tcf MODEL model BINDINGS robot.bindings.yaml)\n"


def session(tmp_path: Path, extends: str = "rpi_pico_bare_metal_jiwy", more: str = "") -> Session:
    shutil.copytree(ROOT / "examples/jiwy/model", tmp_path / "model")
    shutil.copy(ROOT / "examples/jiwy/jiwy.bindings.yaml", tmp_path / "robot.bindings.yaml")
    (tmp_path / "robot.tcf").write_text(TCF.format(extends) + more, encoding="utf-8")
    (tmp_path / "CMakeLists.txt").write_text(CMAKE, encoding="utf-8")
    return session_of(tmp_path)


def pins(state: dict[str, Any]) -> dict[str, str]:
    return {f"{each['component']} {each['signal']}": each["pin"] for each in state["pins"]["signals"]}


def added(state: dict[str, Any]) -> list[str]:
    return [line[1:].strip() for line in state["draft"]["diff"].splitlines() if re.match(r"\+(?!\+\+)", line)]


def test_the_list_and_the_drawing_agree(tmp_path: Path) -> None:
    epg = session(tmp_path)
    options = {each["pin"]: each for each in epg.pin_options("pwm_pan", "value")}
    svg = epg.pinout("pwm_pan", "value")
    shown = {rect.attrib["data-pin"]: rect for rect in ElementTree.fromstring(svg).iter() if "data-pin" in rect.attrib}
    assert shown.keys() == {pin for pin, each in options.items() if each["contact"]}
    for pin, rect in shown.items():
        title = rect[0].text or ""
        assert title.startswith(f"contact {options[pin]['contact']}: {pin}")
        if options[pin]["state"] in ("used", "unfit"):
            assert options[pin]["reason"] in title
    for state in ("fits", "unfit", "used"):
        assert any(each["state"] == state for each in options.values())
        assert f'class="{state}' in svg
    assert 'class="chosen"' in svg
    assert "can be pwm_pan value" in svg
    signals = {f"{each['component']}.{each['signal']}" for each in epg.state()["pins"]["signals"]}
    assert set(re.findall(r'data-signal="([^"]*)"', svg)) == signals
    assert "data-" not in epg.picture("wiring")


def test_another_pin_is_a_line_of_the_users_file(tmp_path: Path) -> None:
    epg = session(tmp_path)
    state = epg.act("choose_pin", {"component": "pwm_pan", "signal": "value", "pin": "GP3"})
    assert pins(state)["pwm_pan value"] == "GP3"
    assert added(state) == ["components:", "pwm_pan: {pins: {value: GP3}}"]
    state = epg.act("choose_pin", {"component": "encoder_pan", "signal": "a", "pin": "GP20"})
    assert (pins(state)["encoder_pan a"], pins(state)["encoder_pan b"]) == ("GP20", "GP21")  # B follows, in one step
    assert pins(epg.act("undo", {}))["encoder_pan b"] == "GP11"
    epg.act("save", {})
    assert (tmp_path / "robot.tcf").read_text(encoding="utf-8").startswith(TCF.format("rpi_pico_bare_metal_jiwy"))


def test_a_pin_that_does_not_fit_is_refused_with_those_that_do(tmp_path: Path) -> None:
    epg = session(tmp_path)
    with pytest.raises(Refused) as refused:
        epg.act("choose_pin", {"component": "pwm_pan", "signal": "value", "pin": "GP5"})
    assert refused.value.message == "GP5 cannot be pwm_pan value: pwm_tilt direction_a uses it"
    assert (
        refused.value.hint == "pins that fit: GP0, GP1, GP3, GP9, GP14-GP19, GP21, GP22, GP25-GP28"
    )  # GP20 shares a channel with GP4
    with pytest.raises(Refused, match="GP24 cannot be pwm_pan value: it senses"):
        epg.act("choose_pin", {"component": "pwm_pan", "signal": "value", "pin": "GP24"})
    with pytest.raises(Refused, match="rpi_pico has no such pin"):
        epg.act("choose_pin", {"component": "pwm_pan", "signal": "value", "pin": "X1"})
    with pytest.raises(Refused, match="no signal 'pwm_pan other'"):
        epg.act("choose_pin", {"component": "pwm_pan", "signal": "other", "pin": "GP3"})
    assert not epg.has_changes


def test_a_conflict_is_drawn(tmp_path: Path) -> None:
    epg = session(tmp_path, more="components:\n  pwm_pan: {pins: {value: 4}}\n")
    state = epg.state()
    assert [each["id"] for each in state["diagnostics"] if each["severity"] == "error"] == ["pin-used-twice"]
    assert state["pictures"]["wiring"]
    shown = {each["name"]: each["where"] for each in state["components"]}
    assert shown["pwm_pan"][0] == "value GP4" and shown["encoder_pan"] == ["a GP10", "b GP11"]
    svg = epg.pinout("", "")
    assert 'class="wrong"' in svg and "an error: see the messages" in svg
    (problem,) = state["pins"]["problems"]
    assert problem == {"component": "pwm_tilt", "signal": "value", "message": "pin 4 is already used by 'pwm_pan'"}
    assert "contact 6: GP4: pwm_pan value and pwm_tilt value" in svg
    state = epg.act("first_pins", {"signals": [{"component": "pwm_pan", "signal": "value"}]})
    assert not [each for each in state["diagnostics"] if each["severity"] == "error"]
    assert pins(state)["pwm_pan value"] == "GP2"


def test_an_error_of_a_peripheral_is_drawn_at_a_pin(tmp_path: Path) -> None:
    epg = session(tmp_path, more="components:\n  slow: {kind: pwm, frequency: 50 Hz, pins: {value: 3}}\n")
    (problem,) = epg.state()["pins"]["problems"]
    assert (problem["component"], problem["signal"]) == ("slow", "value")
    assert "which has only one frequency" in problem["message"]
    assert epg.pinout("", "").count('class="wrong"') == 2  # GP3 and the legend
    assert epg.act("first_pins", {"signals": [problem]})["pins"]["problems"] == []


def test_a_reserved_pin_is_an_error(tmp_path: Path) -> None:
    robot = "nucleo_h743zi_bare_metal_jiwy"
    epg = session(tmp_path, robot, "components:\n  lamp: {kind: digital_output, pins: {value: PA13}}\n")
    assert [each["message"] for each in epg.state()["pins"]["problems"]] == [
        "pin PA13 of nucleo_h743zi is reserved: the debugger uses it"
    ]
    assert 'class="wrong"' in epg.pinout("", "")


def test_components_without_pins_get_the_first_that_fit(tmp_path: Path) -> None:
    epg = session(tmp_path, more="components:\n  relay: {kind: digital_output}\n  lamp: {kind: digital_output}\n")
    state = epg.state()
    assert pins(state)["relay value"] == pins(state)["lamp value"] == ""
    assert "relay value: no pin" in epg.pinout("", "")
    state = epg.act("first_pins", {})
    assert (pins(state)["relay value"], pins(state)["lamp value"]) == ("GP3", "GP9")
    assert not [each for each in state["diagnostics"] if each["severity"] == "error"]
    assert epg.act("first_pins", {})["draft"] == state["draft"]
    with pytest.raises(Refused, match="there is no signal 'relay other'"):
        epg.act("first_pins", {"signals": [{"component": "relay", "signal": "other"}]})


def test_no_pins_are_left(tmp_path: Path) -> None:
    encoders = "".join(f"  e{n}: {{kind: quadrature_encoder, counts_per_revolution: 100}}\n" for n in range(7))
    epg = session(tmp_path, "nucleo_h743zi_bare_metal_jiwy", "components:\n" + encoders)
    with pytest.raises(Refused, match="no free pins fit e0 a, e0 b, e1 a"):
        epg.act("first_pins", {})


def test_a_file_of_epg_is_not_changed(tmp_path: Path) -> None:
    epg = session(tmp_path)
    (tmp_path / "CMakeLists.txt").write_text(
        CMAKE.replace("robot.tcf", "rpi_pico_bare_metal_jiwy.tcf"), encoding="utf-8"
    )
    epg = session_of(tmp_path)
    assert "which EPG does not change" in epg.state()["pins"]["why_not"]
    with pytest.raises(Refused):
        epg.act("first_pins", {"signals": [{"component": "pwm_pan", "signal": "value"}]})


def test_a_target_without_pins_has_no_pinout(tmp_path: Path) -> None:
    epg = session(tmp_path, "host_jiwy")
    assert epg.state()["pins"]["signals"] == []
    assert "wiring" not in epg.state()["pictures"]
    with pytest.raises(Refused):
        epg.pinout("", "")
