# SPDX-License-Identifier: Apache-2.0
"""axe-core finds no violation in any state of the page, light and dark; the page fits narrow and enlarged windows."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest

from tests.doubles.toolchain import skip_if_missing

from .acts import field, handle
from .axe import axe_core, violations
from .conftest import Project
from .served import Served

Open = Callable[..., Any]


@pytest.fixture(scope="module", autouse=True)
def checker() -> None:
    skip_if_missing(axe_core)


def test_start_page(started: Served, open_page: Open) -> None:
    page = open_page(started.address)
    page.locator(".card").first.wait_for()
    page.get_by_role("radio").and_(page.locator(":enabled")).first.check()
    assert violations(page) == []
    page.set_viewport_size({"width": 800, "height": 600})
    assert violations(page) == []
    assert page.evaluate("document.documentElement.scrollWidth") <= 800


def test_diagram_and_details(jiwy: Project, open_page: Open) -> None:
    jiwy.write(
        ("  pwm_tilt: pwm_tilt\n", ""),
        ("  position_tilt: encoder_tilt", "  position_tilt: {from: encoder_tilt, scale: 1/2}"),
        ("  setpoint_pan: pan_subscriber", "  setpoint_pan: {from: pan_subscriber, unit: V}"),
    )
    page = open_page(jiwy.address)
    found = {"diagram": violations(page)}
    field(page, "tilt_logging").select_option("unconnected on purpose")
    page.get_by_text("● Unsaved").wait_for()
    for tab in page.get_by_role("tab").all():
        tab.click()
        found[tab.inner_text()] = violations(page)
    page.locator(".wire-label").first.click()
    found["conversion"] = violations(page)
    page.keyboard.press("Escape")
    page.get_by_role("button", name="Target").click()
    found["target"] = violations(page)
    page.keyboard.press("Escape")
    handle(page, "outputs", "pwm_tilt").focus()
    page.keyboard.press("Enter")
    page.keyboard.press("ArrowDown")
    found["held"] = violations(page)
    page.keyboard.press("Escape")
    jiwy.file.write_text("version: 1\ninputs: [\n", encoding="utf-8")
    page.get_by_role("button", name="Overwrite the file").wait_for()
    found["conflict"] = violations(page)
    page.get_by_role("button", name="Load the file").click()
    page.get_by_text("Connections cannot be changed here").wait_for()
    found["no edits"] = violations(page)
    assert {where: list_ for where, list_ in found.items() if list_} == {}


@pytest.mark.parametrize(
    ("width", "height"), [(1280, 720), (800, 900), (640, 400), (320, 640)], ids=["720p", "narrow", "200 %", "phone"]
)
def test_fits_the_window(jiwy: Project, open_page: Open, width: int, height: int) -> None:
    """Nothing is cut off at the side.  640x400 is 1280x800 enlarged to 200 %."""
    page = open_page(jiwy.address, viewport={"width": width, "height": height})
    assert page.evaluate("document.documentElement.scrollWidth") <= width
    assert page.evaluate("document.getElementById('main').scrollWidth") <= width
    assert violations(page) == []
    field(page, "tilt_logging").select_option("unconnected on purpose")
    page.get_by_text("● Unsaved").wait_for()
    page.get_by_role("button", name="Generate", exact=True).scroll_into_view_if_needed()
    assert page.get_by_role("button", name="Generate", exact=True).is_visible()
