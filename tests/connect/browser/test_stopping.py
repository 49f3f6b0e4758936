# SPDX-License-Identifier: Apache-2.0
"""While a robot is enabled, space, Escape and *Stop robot* stop it from everything on the page."""

from __future__ import annotations

import os
import re
import signal
import time
from collections.abc import Callable
from typing import Any

import pytest

from .acts import let_pass, until
from .axe import violations
from .way import Way

NOT_CONFIRMED = "Stop was NOT confirmed: switch the supply off."
COVERED = """() => {
  const button = document.querySelector("#robot button.stop");
  const { left, right, top, bottom } = button.getBoundingClientRect();
  const covered = [[left + 2, top + 2], [right - 2, top + 2], [left + 2, bottom - 2], [right - 2, bottom - 2]]
    .filter(([x, y]) => document.elementFromPoint(x, y) !== button);
  return [covered.length, button.closest("[inert]") !== null];
}"""


def in_the_command(page: Any) -> None:
    page.locator("#live-command").focus()


def on_a_check_box(page: Any) -> None:
    page.locator(".live-signals input").first.focus()


def on_a_plot(page: Any) -> None:
    page.locator(".plots .u-over").first.click()


def on_a_list(page: Any) -> None:
    page.get_by_label("Trigger").focus()


def in_another_tab(page: Any) -> None:
    page.get_by_role("tab", name="Problems").click()


def in_a_dialog(page: Any) -> None:
    page.evaluate(
        "(async () => { const { openDialog } = await import(new URL('dialog.js', location));"
        " const { h } = await import(new URL('dom.js', location));"
        " const field = { type: 'text', id: 'in-dialog', 'aria-label': 'a field' };"
        " openDialog('test', 'A dialog', () => [h('input', field)]); })()"
    )
    page.locator("#in-dialog").focus()


def while_dragging(page: Any) -> None:
    page.get_by_role("button", name="Smaller").click()
    handle = page.locator("[data-handle]").first
    handle.hover()
    page.mouse.down()
    page.mouse.move(300, 300, steps=3)


PLACES: list[Callable[[Any], None]] = [
    in_the_command, on_a_check_box, on_a_plot, on_a_list, in_another_tab, in_a_dialog, while_dragging,
]  # fmt: skip


@pytest.mark.parametrize("key", ["Space", "Escape"])
def test_a_key_stops_from_everything(way: Way, key: str) -> None:
    way.connect()
    way.enable_unattended()
    for number, place in enumerate(PLACES):
        if number:
            way.epg.post("live/stop")
            way.page.get_by_role("tab", name="Live").click()
            if way.page.get_by_role("button", name="Larger").is_visible():
                way.page.get_by_role("button", name="Larger").click()
            way.enable_unattended()
        place(way.page)
        before = way.page.evaluate("document.activeElement.value ?? null")
        checked = way.page.locator(".live-signals input:checked").count()
        way.page.keyboard.press(key)
        way.stops_within(2, place.__name__)
        assert way.page.evaluate("document.activeElement.value ?? null") == before, (
            f"{place.__name__}: it types nothing"
        )
        assert way.page.locator(".live-signals input:checked").count() == checked
        if place is in_a_dialog:
            assert way.page.get_by_role("dialog").is_visible(), "the key does nothing else"
            way.bar.get_by_text("disabled").wait_for()
            let_pass(way.page.evaluate, 0.5)
            way.page.keyboard.press("Escape")
            way.page.get_by_role("dialog").wait_for(state="detached")
        way.page.mouse.up()


def test_while_the_robot_is_disabled_space_types_and_escape_closes(way: Way) -> None:
    way.connect()
    way.page.get_by_role("tab", name="Live ○ disabled").wait_for()
    field = way.page.locator("#live-command")
    field.press_sequentially("get x")
    assert field.input_value() == "get x"
    box = way.page.locator(".live-signals input").first
    checked = box.is_checked()
    box.press("Space")
    assert box.is_checked() != checked


@pytest.mark.parametrize("width, height", [(1280, 800), (800, 500), (400, 700)])
def test_the_button_is_never_covered(way: Way, width: int, height: int) -> None:
    way.connect()
    way.enable_unattended()
    way.page.set_viewport_size({"width": width, "height": height})
    for tab in ("Live", "Problems", "Settings"):
        way.page.get_by_role("tab", name=tab).click()
        way.page.evaluate("window.scrollTo(0, document.documentElement.scrollHeight)")
        assert way.page.evaluate(COVERED) == [0, False], tab
    in_a_dialog(way.page)
    assert way.page.evaluate(COVERED) == [0, False]
    assert violations(way.page) == []
    assert way.page.get_by_role("button", name="Settings").count() == 0, "nothing else can be used"
    way.page.get_by_role("button", name="Stop robot").click()
    way.stops_within(2)
    assert way.page.get_by_role("dialog").is_visible()


# A Stop that nobody confirms


def server(way: Way) -> int:
    return way.epg.process


def target(way: Way) -> int:
    return way.robot.process.pid


def line(way: Way) -> int:
    return way.line.process.pid


@pytest.mark.parametrize("part", [server, target, line])
@pytest.mark.parametrize("leased", [True, False], ids=["leased", "unattended"])
def test_a_stop_that_is_not_confirmed_says_so_and_goes_on(way: Way, part: Callable[[Way], int], leased: bool) -> None:
    way.connect()
    way.enable() if leased else way.enable_unattended()
    os.kill(part(way), signal.SIGSTOP)
    late, begin = way.late(), time.monotonic()  # the time that a user waits
    way.page.keyboard.press("Space")
    way.page.get_by_role("alert").get_by_text(NOT_CONFIRMED).wait_for()
    # the time that a user waits
    assert 0.4 < time.monotonic() - begin < 3 + way.late() - late, "it has waited for the confirmation"
    way.page.get_by_text("values are old: no news for").first.wait_for()
    assert way.page.get_by_role("tab", name="Live ? old").is_visible()
    assert way.page.get_by_text("The values are old: no news for").is_visible()
    way.page.get_by_text(re.compile(r"The values are old: no news for ([2-9]|\d\d+) s")).wait_for()
    assert way.page.get_by_text(NOT_CONFIRMED).is_visible()
    os.kill(part(way), signal.SIGCONT)
    way.stops_within(5)
    way.page.get_by_text(NOT_CONFIRMED).wait_for(state="detached")
    way.page.get_by_role("tab", name="Live ○ disabled").wait_for()


def test_a_stop_after_the_cable_is_out_goes_on_until_it_is_in_again(way: Way) -> None:
    way.connect()
    way.enable_unattended()
    way.line.process.kill()
    way.bar.get_by_text("is not connected any more. It was enabled unattended, and can still move").wait_for()
    way.page.get_by_role("button", name="Stop robot").click()
    way.page.get_by_role("alert").get_by_text(NOT_CONFIRMED).wait_for()
    assert way.robot.is_driven()
    way.reconnect_line()
    way.stops_within(10)
    way.page.get_by_text(NOT_CONFIRMED).wait_for(state="detached")


def test_a_suspended_laptop_shows_no_old_value_as_new(way: Way) -> None:
    """Server and browser stand still, and the clock of the wall goes on, as after a suspend."""
    way.connect()
    way.enable_unattended()
    stopped = [way.epg.process, *way.renderers()]
    for process in stopped:
        os.kill(process, signal.SIGSTOP)
    way.robot.close()
    time.sleep(2)  # the time for which a laptop sleeps
    for process in stopped:
        os.kill(process, signal.SIGCONT)
    way.page.get_by_text("is not connected any more. It was enabled unattended").wait_for()


def test_values_become_old_by_the_clock_that_goes_on(way: Way) -> None:
    """The other clock of a browser stands still while the computer is suspended."""
    way.connect()
    way.enable()
    # a clock that stands still
    way.page.evaluate("(() => { const at = performance.now(); performance.now = () => at; })()")
    os.kill(way.epg.process, signal.SIGSTOP)
    until(way.page, "document.body.classList.contains('old')", 10)
