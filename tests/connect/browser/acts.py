# SPDX-License-Identifier: Apache-2.0
"""Actions of a user on the page, and functions that wait for their effect."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any


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


def until(page: Any, expression: str, seconds: float = 5) -> None:
    """Waits until a JavaScript expression is true.  Playwright's own function needs eval(), which the page forbids."""
    end = time.monotonic() + seconds
    while not page.evaluate(expression):
        assert time.monotonic() < end, expression
        time.sleep(0.02)
