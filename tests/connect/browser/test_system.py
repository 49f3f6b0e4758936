# SPDX-License-Identifier: Apache-2.0
"""A system on the page: boxes that open targets, lines between them, its messages; by pointer and by keyboard."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

from tests.connect.test_overview import edit, write_pair
from tests.doubles.toolchain import Missing

from .acts import port, until
from .axe import violations
from .served import Served

Open = Callable[..., Any]


@pytest.fixture
def pair(browser: Any, tmp_path: Path) -> Iterator[Served]:
    path = write_pair(tmp_path / "pair")
    with Served(path) as served:
        served.path = path  # type: ignore[attr-defined]
        yield served


def wrong(page: Any) -> list[str]:
    try:
        return violations(page)
    except Missing as reason:
        pytest.skip(str(reason))


def test_from_the_system_to_a_target_and_back_by_keyboard(pair: Served, open_page: Open) -> None:
    page = open_page(pair.address)
    leader = page.get_by_role("article", name="leader")
    assert "to follower/pan_subscriber, rad, every 33 ms" in leader.inner_text()
    assert "from other programs, topic /pair/leader/setpoint_pan" in leader.inner_text()
    until(page, "document.querySelectorAll('#lanes .lane').length == 2")
    box, lane = leader.bounding_box(), page.locator("#lanes .lane").first.bounding_box()
    assert lane["x"] >= box["x"] + box["width"] - 1
    page.get_by_role("button", name="Open leader").focus()
    page.keyboard.press("Enter")
    page.get_by_role("button", name="Back to the system pair").wait_for()
    assert page.evaluate("document.activeElement.id") == "main"
    assert "By the system: topic /pair/leader/setpoint_pan" in port(page, "setpoint_pan").inner_text()
    assert port(page, "setpoint_pan").locator("select").count() == 0
    page.get_by_role("button", name="Back to the system pair").focus()
    page.keyboard.press("Enter")
    leader.wait_for()
    until(page, "document.activeElement.id == 'open-leader'")


def test_states_of_a_system(pair: Served, open_page: Open) -> None:
    """Each state fits four windows, and axe-core finds nothing."""
    page = open_page(pair.address)
    page.get_by_text("No problems. All targets and connections are right.").wait_for()
    found = {}
    for tab in page.get_by_role("tab").all():
        tab.click()
        found[tab.inner_text()] = wrong(page)
    until(page, "document.querySelector('img.picture')?.naturalWidth > 0")
    edit(pair.path.parent / "leader.bindings.yaml", "pwm_tilt: pwm_tilt", "pwm_tilt: pwm_tlt")  # type: ignore[attr-defined]
    page.get_by_role("article", name="leader").get_by_text("1 error").wait_for()
    page.get_by_role("tab", name="Problems").click()
    page.get_by_role("button", name="Open leader").nth(1).wait_for()
    for width, height in ((1280, 720), (800, 900), (640, 400), (400, 800)):
        page.set_viewport_size({"width": width, "height": height})
        assert page.evaluate("document.documentElement.scrollWidth") <= width
        assert page.evaluate("document.getElementById('main').scrollWidth") <= width
        found[f"{width}"] = wrong(page)
    assert {where: list_ for where, list_ in found.items() if list_} == {}
