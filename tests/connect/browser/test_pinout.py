# SPDX-License-Identifier: Apache-2.0
"""Pins on the board's drawing: dragged, clicked, and chosen by keyboard; printed on one page."""

from __future__ import annotations

import shutil
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

from tests.doubles.toolchain import skip_if_missing

from .acts import drag, until
from .axe import axe_core, violations
from .served import ROOT, Served

Open = Callable[..., Any]
WIDE = """components:
  limit_a: {kind: digital_input, pins: {value: 16}}
  limit_b: {kind: digital_input, pins: {value: 22}}
  lamp: {kind: digital_output, pins: {value: 28}}
"""


class Robot:
    """A served project for a Pico, with components on both sides of the board."""

    def __init__(self, folder: Path) -> None:
        self.tcf = folder / "robot.tcf"
        self.text = f"version: 1\nextends: rpi_pico_bare_metal_jiwy.tcf\n{WIDE}"
        self.tcf.write_text(self.text, encoding="utf-8")
        bindings = folder / "jiwy.bindings.yaml"
        shutil.copy(ROOT / "examples/jiwy/jiwy.bindings.yaml", bindings)
        self.epg = Served("--tcf", self.tcf, "--model", ROOT / "examples/jiwy/model", "--bindings", bindings)

    def pin(self, component: str, signal: str) -> str:
        signals = self.epg.state()["pins"]["signals"]
        return next(s["pin"] for s in signals if (s["component"], s["signal"]) == (component, signal))


@pytest.fixture(scope="module")
def robot(browser: Any, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Robot]:
    made = Robot(tmp_path_factory.mktemp("pins"))
    yield made
    made.epg.end()


@pytest.fixture
def page(robot: Robot, open_page: Open) -> Any:
    robot.tcf.write_text(robot.text, encoding="utf-8")
    robot.epg.post("reload")
    page = open_page(robot.epg.address)
    page.get_by_role("tab", name="Pinout").click()
    page.locator(".board svg").wait_for()
    return page


def contact(page: Any, pin: str) -> Any:
    return page.locator(f'.board [data-pin="{pin}"]')


def terminal(page: Any, signal: str) -> Any:
    return page.locator(f'.board [data-signal="{signal}"]').first


def test_a_signal_is_dragged_onto_a_contact(robot: Robot, page: Any) -> None:
    page.get_by_role("button", name="Larger").click()
    page.set_viewport_size({"width": 1280, "height": 1400})
    drag(page, terminal(page, "pwm_pan.value"), contact(page, "GP3"))
    page.get_by_text("Disconnect the motor supply").wait_for()
    assert robot.pin("pwm_pan", "value") == "GP3"
    until(page, "document.getElementById('pin-signal').value === 'pwm_pan.value'")
    page.get_by_role("button", name="OK").click()
    drag(page, contact(page, "GP10"), contact(page, "GP20"))  # the contact of encoder_pan a
    until(page, "document.getElementById('pin-signal').selectedOptions[0].text === 'encoder_pan a: GP20'")
    assert robot.pin("encoder_pan", "b") == "GP21"
    assert page.get_by_text("Disconnect the motor supply").count() == 0  # it was said once
    page.get_by_role("button", name="Save", exact=True).click()
    page.get_by_text("Saved", exact=True).wait_for()
    assert "{value: GP3}" in robot.tcf.read_text(encoding="utf-8")


def test_clicks_choose_a_signal_and_its_pin(robot: Robot, page: Any) -> None:
    contact(page, "GP2").click()  # the contact of pwm_pan value
    page.locator(".pins button").first.wait_for()
    contact(page, "GP4").click()
    alert = page.get_by_role("alert")
    alert.get_by_text("GP4 cannot be pwm_pan value: pwm_tilt value uses it").wait_for()
    assert "pins that fit: GP0, GP1, GP3" in alert.inner_text()
    assert page.locator(".board .refused").get_attribute("data-pin") == "GP4"  # the conflict is marked at its place
    contact(page, "GP3").click()
    until(page, "document.getElementById('pin-signal').selectedOptions[0].text === 'pwm_pan value: GP3'")
    alert.wait_for(state="detached")
    page.locator(".board .refused").wait_for(state="detached")
    assert robot.pin("pwm_pan", "value") == "GP3"


def test_the_same_by_keyboard(robot: Robot, page: Any) -> None:
    skip_if_missing(axe_core)
    page.get_by_label("Signal").focus()
    page.keyboard.type("lamp")  # the list goes to the option that begins so
    until(page, "document.querySelectorAll('.pins button').length > 5")
    assert violations(page) == []
    page.locator(".pins button").first.focus()
    page.keyboard.press("Enter")
    page.get_by_text("Disconnect the motor supply").wait_for()
    assert robot.pin("lamp", "value") == "GP0"
    until(page, "document.querySelector('.pins button').textContent !== 'GP0'")
    page.get_by_role("button", name="First that fits", exact=True).focus()
    page.keyboard.press("Enter")
    until(page, "document.getElementById('pin-signal').selectedOptions[0].text === 'lamp value: GP3'")
    page.get_by_text("that do not fit").click()
    assert violations(page) == []
    page.set_viewport_size({"width": 400, "height": 800})
    assert page.evaluate("document.documentElement.scrollWidth") <= 400
    assert violations(page) == []


def test_a_conflict_in_the_file_is_solved(robot: Robot, page: Any) -> None:
    robot.tcf.write_text(robot.text.replace("{value: 28}", "{value: 22}"), encoding="utf-8")
    page.locator(".board .wrong").first.wait_for()
    problem = page.locator(".pin-problems li")
    problem.get_by_text("lamp value: pin 22 is already used by 'limit_b'").wait_for()
    problem.get_by_role("button", name="Choose").click()
    page.get_by_role("button", name="First that fits", exact=True).click()
    problem.wait_for(state="detached")
    assert robot.pin("lamp", "value") == "GP3"


def test_components_without_pins(robot: Robot, page: Any) -> None:
    robot.tcf.write_text(robot.text.replace(", pins: {value: 16}", ""), encoding="utf-8")
    page.get_by_role("button", name="Find pins for 1 signal without one").click()
    until(page, "!document.querySelector('.pin-tools .primary')")
    assert robot.pin("limit_a", "value") == "GP3"


def test_the_picture_alone_is_printed_on_one_page(page: Any) -> None:
    with page.context.expect_page() as opened:
        page.get_by_role("link", name="Open in a new tab").click()
    alone = opened.value
    alone.wait_for_load_state()
    assert alone.evaluate("getComputedStyle(document.querySelector('.board')).fill") != "rgb(0, 0, 0)"
    wide, high = alone.evaluate(
        "[document.documentElement.width.baseVal.value, document.documentElement.height.baseVal.value]"
    )
    assert wide > 794 * 1.05 or high > 1123  # larger than A4
    assert alone.pdf(format="A4", prefer_css_page_size=True).count(b"/Type /Page\n") == 1
