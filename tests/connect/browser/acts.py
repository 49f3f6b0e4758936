# SPDX-License-Identifier: Apache-2.0
"""Actions of a user on the page, and functions that wait for their effect."""

from __future__ import annotations

import os
from collections.abc import Callable
from typing import Any

from tests import waiting
from tests.live.target import LEASE

HOLD = 700
"""Milliseconds for which a user holds a button."""
NEWEST = "(async () => (await import(new URL('live_events.js', location))).live.times.at(-1) ?? null)()"
"""The newest time of the target on a live page, in seconds."""


def let_pass(evaluate: Callable[[str], Any], seconds: float) -> None:
    """Waits until the target has run for some seconds of its own time, as a live page shows it."""
    end = waiting.until(lambda: evaluate(NEWEST), "the page gets no values") + seconds
    waiting.until(lambda: (evaluate(NEWEST) or 0.0) >= end, "the target does not run", 60 + 3 * seconds, pause=0.05)


def handle(page: Any, side: str, name: str) -> Any:
    """The handle at the end of a wire, which the user can drag."""
    return page.locator(f'[data-handle][data-side="{side}"][data-name="{name}"]')


def port(page: Any, name: str) -> Any:
    """A port of the model."""
    return page.locator(f'.ports .port[data-name="{name}"]')


def field(page: Any, name: str) -> Any:
    """The list of everything that a port can be connected with."""
    return port(page, name).locator("select").first


def drag(page: Any, start: Any, end: Any, *, halfway: Callable[[], None] | None = None) -> None:
    start.scroll_into_view_if_needed()
    one, other = start.bounding_box(), end.bounding_box()
    page.mouse.move(one["x"] + one["width"] / 2, one["y"] + one["height"] / 2)
    page.mouse.down()
    page.mouse.move(one["x"] + 30, one["y"] + 10, steps=3)
    if halfway:
        halfway()
    page.mouse.move(other["x"] + other["width"] / 2, other["y"] + other["height"] / 2, steps=5)
    page.mouse.up()


def save(page: Any) -> None:
    page.get_by_role("button", name="Save", exact=True).click()
    page.get_by_text("Saved", exact=True).wait_for()


def tab_to(page: Any, condition: str, key: str = "Tab") -> None:
    """Presses Tab until ``condition`` is true of the element ``it`` that has the focus."""
    for _ in range(160):
        page.keyboard.press(key)
        if page.evaluate(f"(() => {{ const it = document.activeElement; return {condition}; }})()"):
            return
    raise AssertionError(f"Tab does not lead to: {condition}")


def processes(browser: Any) -> list[dict[str, Any]]:
    """The processes of a browser, each with its ``id`` and ``type``."""
    found: list[dict[str, Any]] = browser.new_browser_cdp_session().send("SystemInfo.getProcessInfo")["processInfo"]
    return found


def late(browser: Any, *others: int) -> float:
    """Seconds for which this test, the browser and other processes had no processor so far."""
    return sum(map(waiting.waited, (os.getpid(), *others, *(each["id"] for each in processes(browser)))))


def drive(act: Callable[[], None], is_driven: Callable[[], bool], browser: Any, *others: int) -> None:
    """Acts until the robot is driven.  As a user does, it acts again if a late computer has made the page late."""
    for _ in range(5):
        before = late(browser, *others)
        act()
        if waiting.soon(is_driven, 3):  # the page may need a second act
            return
        assert late(browser, *others) > before + LEASE, "the robot is not enabled, and the computer was not late"
    raise AssertionError("the robot is not enabled")


def enable(page: Any, *others: int) -> None:
    """Holds the button while another element has the focus; a click alone must have no effect."""
    button = page.get_by_role("button", name="Enable (hold)")
    button.click()
    let_pass(page.evaluate, HOLD / 1000)
    page.get_by_role("textbox", name="pan_subscriber").focus()
    assert page.get_by_role("tab", name="Live ○ disabled").is_visible(), "a click is too short"
    enabled = page.get_by_role("tab", name="Live ● enabled")
    drive(lambda: button.click(delay=HOLD), enabled.is_visible, page.context.browser, *others)


def generate(page: Any) -> None:
    """Begins the first build in a folder, and agrees to its commands."""
    page.get_by_role("button", name="Generate", exact=True).click()
    page.get_by_role("dialog", name="Run these commands?").get_by_role("button", name="Run").click()


def run_program(page: Any, name: str) -> None:
    """Runs a product in real time, and agrees to its command."""
    panel = page.get_by_role("tabpanel")
    panel.get_by_role("button", name=f"Run {name} in real time").click()
    page.get_by_role("dialog").get_by_role("button", name="Run", exact=True).click()
    panel.get_by_text(f"{name} runs in real time.").wait_for()


def until(page: Any, expression: str, seconds: float = waiting.PATIENCE) -> None:
    """Waits until a JavaScript expression is true.  Playwright's own function needs eval(), which the page forbids."""
    waiting.until(lambda: page.evaluate(expression), expression, seconds, pause=0.02)
