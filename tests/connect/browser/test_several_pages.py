# SPDX-License-Identifier: Apache-2.0
"""Several tabs, windows and browsers show one target: values arrive in each, and each can keep it enabled.

No page moves anything before it has got values of the target, and its own answers have come back in time.
"""

from __future__ import annotations

import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from tests.live.target import LATE, LEASE
from tests.live.witness import PROJECT, Robot

from .acts import NEWEST, let_pass
from .firefox import Firefox
from .served import Served
from .way import Way

HOLD = 0.7
"""Seconds."""
READY = "button.hold:enabled:not([aria-disabled])"


@pytest.fixture
def robot(robot_program: Path, tmp_path: Path) -> Iterator[Robot]:
    with Robot(robot_program, tmp_path) as found:
        yield found


def stays_enabled(robot: Robot, page: Any) -> None:
    robot.wait(driven=True)
    let_pass(page.evaluate, 3 * LEASE)
    assert robot.is_driven(), "its page keeps it enabled"


def stop(robot: Robot, epg: Served) -> None:
    epg.post("live/stop")
    robot.wait(driven=False)


def show_live_in(firefox: Firefox, address: str) -> None:
    firefox.open(address)
    firefox.click("#tab-live")
    firefox.until(f"document.querySelector('{READY}')", 20)


def show_live(page: Any, address: str) -> None:
    page.goto(address)
    page.get_by_role("tab", name="Live").click()
    page.locator(READY).wait_for()


def test_tabs_and_windows_of_chromium(way: Way) -> None:
    way.connect()
    way.page.locator(READY).wait_for()
    tab = way.page.context.new_page()
    window = way.browser.new_context().new_page()
    for page in (tab, window):
        show_live(page, way.epg.address)
        first = page.evaluate(NEWEST)
        page.get_by_role("button", name="Enable (hold)").click(delay=1000 * HOLD)
        stays_enabled(way.robot, page)
        assert page.evaluate(NEWEST) > first, "values arrive"
        assert way.page.evaluate(NEWEST) > first, "and in the other one"
        stop(way.robot, way.epg)


def test_tabs_of_firefox(robot: Robot, firefox: Firefox) -> None:
    with Served(PROJECT) as epg:
        epg.post("live/connect", path=str(robot.port))
        show_live_in(firefox, epg.address)
        firefox.new_tab()
        try:
            show_live_in(firefox, epg.address)
            first = firefox.evaluate(NEWEST)
            firefox.hold("button.hold", HOLD)
            stays_enabled(robot, firefox)
            assert firefox.evaluate(NEWEST) > first, "values arrive in the second tab"
            stop(robot, epg)
            firefox.show_tab(0)
            firefox.until(f"document.querySelector('{READY}')", 20)
            assert firefox.evaluate(NEWEST) > first, "and in the first one"
            firefox.hold("button.hold", HOLD)
            stays_enabled(robot, firefox)
        finally:
            firefox.close_tab()
        stop(robot, epg)


def test_two_browsers(way: Way, firefox: Firefox) -> None:
    way.connect()
    way.page.locator(READY).wait_for()
    show_live_in(firefox, way.epg.address)
    way.enable()
    stays_enabled(way.robot, way.page)
    firefox.press("Escape")
    way.robot.wait(driven=False)
    firefox.until("document.getElementById('robot').textContent.includes('disabled')")
    firefox.until(f"document.querySelector('{READY}')", 20)
    firefox.hold("button.hold", HOLD)
    stays_enabled(way.robot, firefox)
    way.page.get_by_role("tab", name="Live ● enabled").wait_for()
    way.page.keyboard.press("Space")
    way.robot.wait(driven=False)


def test_a_page_without_values_moves_nothing(way: Way) -> None:
    """As many tabs as use all connections of the browser: the last one gets no events."""
    way.connect()
    way.page.locator(READY).wait_for()
    way.page.evaluate(
        "(async () => { const { jsonLines } = await import(new URL('server.js', location));"
        " for (let n = 0; n < 4; n++) jsonLines(`api/live/events?page=${n}`).next(); })()"
    )
    last = way.page.context.new_page()
    last.goto(way.epg.address)
    let_pass(way.page.evaluate, 3.0)
    assert last.locator(READY).count() == 0
    answer = last.evaluate(
        "(async () => { const { ask } = await import(new URL('server.js', location));"
        " const move = { page: 'last', actuator: 'motor', duty: 0.1 };"
        " return [await ask('enable', { page: 'last' }), await ask('move', move)]; })()"
    )
    assert all("this page does not answer in time" in each["error"]["message"] for each in answer)
    assert way.robot.spans() == []


@pytest.mark.parametrize("browser", ["chromium", "firefox"])
def test_the_lease_does_not_wait_for_drawing(browser: str, way: Way, request: Any) -> None:
    """The thread of the page stands still for less than a worker waits for it, and then for longer."""
    # the page's thread stands still
    block = "(() => { const end = performance.now() + %d; while (performance.now() < end); })()"
    if browser == "firefox":
        firefox = request.getfixturevalue("firefox")
        way.epg.post("live/connect", path=str(way.line.port))
        show_live_in(firefox, way.epg.address)
        firefox.hold("button.hold", HOLD)
        way.robot.wait(driven=True)
        evaluate = firefox.evaluate
    else:
        way.connect()
        way.enable()
        evaluate = way.page.evaluate
    for _ in range(3):
        let_pass(evaluate, 0.3)
        evaluate(block % 500)
        assert len(way.robot.spans()) == 1 and way.robot.is_driven(), "the worker has answered"
    begin = time.monotonic()  # compared with the target's time
    evaluate(block % 2000)
    way.robot.wait(driven=False)
    assert way.robot.spans()[-1].last <= begin + 2.0 + LEASE + LATE
    state = way.epg.until(lambda state: "was late" in (state["live"]["target"]["fault"] or {}).get("text", ""))
    assert "The page was late: it did not answer for" in state["live"]["target"]["fault"]["text"]
