# SPDX-License-Identifier: Apache-2.0
"""The parameters of components and the settings in the page; a robot that is built by keyboard alone."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

from epg.cli.main import main
from tests.connect.robots import own_axis_project, with_second_target
from tests.doubles.toolchain import skip_if_missing

from .acts import tab_to, until
from .axe import axe_core, violations
from .conftest import Project
from .served import Served

Open = Callable[..., Any]


class Keyboard:
    """A user without a pointer."""

    def __init__(self, page: Any) -> None:
        self.page = page

    def to(self, condition: str) -> None:
        tab_to(self.page, condition)

    def press(self, key: str) -> None:
        self.page.keyboard.press(key)

    def write(self, field: str, text: str) -> None:
        """Fills the field with this id."""
        self.to(f"it.id === '{field}'")
        self.press("Control+a")
        self.page.keyboard.type(text)

    def choose(self, field: str, value: str) -> None:
        """Opens the list with this id, and chooses."""
        self.to(f"it.id === '{field}'")
        values = self.page.evaluate("[...document.activeElement.options].map((each) => each.value)")
        steps = values.index(value) - self.page.evaluate("document.activeElement.selectedIndex")
        self.press("Space")
        for _ in range(abs(steps)):
            self.press("ArrowDown" if steps > 0 else "ArrowUp")
        self.press("Enter")
        until(self.page, f"document.getElementById('{field}').value === '{value}'")

    def add(self, kind: str, name: str, texts: dict[str, str] | None = None, boxes: tuple[str, ...] = ()) -> None:
        self.to("it.className === 'add-component'")
        self.press("Enter")
        self.to(f"it.id === 'kind-{kind}'")
        self.press("Enter")
        until(self.page, "document.activeElement.id === 'add-name'")
        self.press("Control+a")
        self.page.keyboard.type(name)
        for box in boxes:
            self.to(f"it.id === 'add-{box}'")
            self.press("Space")
        for field, text in (texts or {}).items():
            if self.page.evaluate(f"document.getElementById('add-{field}').localName") == "select":
                self.choose(f"add-{field}", text)
            else:
                self.write(f"add-{field}", text)
        self.to("it.textContent === 'Add'")
        self.press("Enter")
        until(self.page, "document.activeElement.id === 'component-choice' && !document.querySelector('dialog')")
        assert self.page.evaluate("document.activeElement.value") == name

    def wire(self, port: str, reference: str) -> None:
        self.choose(f"ends-{port}-0", f":{reference}")


def build_robot(user: Keyboard) -> None:
    """An axis with encoder, motor, limit switch and guard in place of the topics of the project, and a stop."""
    user.add("quadrature_encoder", "encoder", {"counts_per_revolution": "4096"})
    user.add("pwm_h_bridge", "motor")
    for name in ("limit", "emergency_stop"):
        user.add("digital_input", name)
        user.choose(f"field-components-{name}-pull", "up")
        user.choose(f"field-components-{name}-invert", "true")
    user.add("motion_guard", "guard", {"actuator": "motor", "encoder": "encoder"}, boxes=("stall",))
    for port, component in (("position_x", "encoder"), ("end_x", "limit"), ("duty_x", "motor")):
        user.wire(port, component)
    user.to("it.id === 'tab-component'")
    user.press("ArrowRight")
    until(user.page, "document.activeElement.id === 'tab-settings'")
    user.choose("field-control-fail_safe", "emergency_stop")
    user.write("field-control-period", "1 ms")
    user.press("Enter")
    until(user.page, "document.getElementById('field-control-period').parentElement.querySelector('.origin')")
    user.to("it.className === 'leave-out'")
    user.press("Enter")
    until(user.page, "!document.querySelector('.leave-out')")
    user.press("Control+s")
    until(user.page, "document.querySelector('.saved').textContent === 'Saved'")


@pytest.fixture
def one_axis(browser: Any, tmp_path: Path) -> Iterator[tuple[Served, Path]]:
    folder = own_axis_project(tmp_path)
    with Served(folder) as served:
        yield served, folder


def test_a_robot_of_one_axis_by_keyboard(one_axis: tuple[Served, Path], open_page: Open) -> None:
    served, folder = one_axis
    page = open_page(served.address)
    page.locator(".diagram").wait_for()
    build_robot(Keyboard(page))
    state = served.state()
    assert [each["message"] for each in state["diagnostics"] if each["severity"] != "note"] == []
    components = {each["name"] for each in state["components"]}
    assert components == {"encoder", "motor", "limit", "guard", "setpoint_x", "emergency_stop"}
    files = ["--tcf", folder / "robot.tcf", "--model", folder / "model", "--bindings", folder / "robot.bindings.yaml"]
    assert main(["check", *map(str, files)]) == 0


def test_a_file_of_epg_is_shown_but_not_changed(jiwy: Project, open_page: Open) -> None:
    page = open_page(jiwy.address)
    page.get_by_role("button", name="pwm_pan", exact=True).first.click()
    frequency = page.get_by_label("frequency")
    assert frequency.input_value() == "20 kHz" and frequency.is_disabled()
    page.get_by_text("which EPG does not change").first.wait_for()


def test_messages_lead_to_their_fields(one_axis: tuple[Served, Path], open_page: Open) -> None:
    skip_if_missing(axe_core)
    served, _ = one_axis
    page = open_page(served.address)
    served.post("add", kind="pwm_h_bridge", name="motor", values={})
    page.get_by_role("button", name="motor", exact=True).click()
    assert page.locator("#component-choice").input_value() == "motor"

    frequency = page.get_by_label("frequency")
    assert (frequency.input_value(), frequency.get_attribute("placeholder")) == ("", "default: 20 kHz")
    frequency.fill("20 Kilo")
    frequency.press("Enter")
    field = page.locator(".field", has=frequency)
    field.get_by_text("unknown unit 'Kilo'").wait_for()
    assert page.get_by_role("button", name="motor", exact=True).is_visible()  # the drawing stays
    assert violations(page) == []
    page.get_by_role("tab", name="Problems").click()
    page.locator(".problem", has_text="Kilo").click()
    until(page, "document.activeElement.id === 'field-components-motor-frequency'")
    page.get_by_role("button", name="Take frequency back to default 20 kHz").click()
    until(page, "!document.querySelector('.field.has-error')")
    until(page, "document.activeElement.id === 'field-components-motor-frequency'")
    assert "components.motor.frequency" not in served.state()["forms"]["values"]

    page.set_viewport_size({"width": 400, "height": 800})
    assert page.evaluate("document.documentElement.scrollWidth") <= 400
    page.get_by_role("button", name="Remove", exact=True).click()
    assert violations(page) == []
    page.keyboard.press("Escape")
    page.get_by_role("button", name="Add a component").first.click()
    assert violations(page) == []
    page.get_by_role("button", name="quadrature encoder").click()
    page.get_by_role("button", name="Add", exact=True).click()
    page.get_by_text("one of these must be set").wait_for()
    assert violations(page) == []
    page.emulate_media(color_scheme="dark")
    assert violations(page) == []
    assert page.evaluate("document.documentElement.scrollWidth") <= 400


def test_errors_in_another_target_need_an_agreement(browser: Any, tmp_path: Path, open_page: Open) -> None:
    folder = with_second_target(own_axis_project(tmp_path))
    with Served(folder) as served:
        page = open_page(served.address)
        page.get_by_role("button", name="position_x", exact=True).click()
        page.get_by_text("touches these targets, too: second").wait_for()
        page.get_by_role("button", name="Remove", exact=True).click()
        page.get_by_text("Wires of these ports: position_x").wait_for()
        page.get_by_role("dialog").get_by_role("button", name="Remove", exact=True).click()
        page.get_by_role("button", name="Save", exact=True).click()
        page.get_by_text("second: there is no component 'position_x'").wait_for()
        assert "position_x:" in (folder / "robot.tcf").read_text()
        page.get_by_role("button", name="Save with these errors").click()
        page.get_by_text("Saved", exact=True).wait_for()
        assert "  position_x:" not in (folder / "robot.tcf").read_text()
