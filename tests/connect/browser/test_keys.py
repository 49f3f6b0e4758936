# SPDX-License-Identifier: Apache-2.0
"""The page without a mouse, in Chromium and in Firefox: each action by keys, the way of Tab, and the focus."""

from __future__ import annotations

import os
import signal
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from tests.connect.test_overview import write_pair
from tests.doubles.toolchain import skip_if_missing
from tests.live.target import Target

from .axe import axe_core, violations_by
from .keys import Chromium, Keys
from .served import Served

BAR = "document.getElementById('robot').textContent"
DISABLED = f"{BAR}.includes('disabled') && document.querySelector('button.hold:enabled:not([aria-disabled])')"
ENABLED = f"{BAR}.includes('robot enabled') || {BAR}.includes('jiwy enabled')"
SAVED = "document.querySelector('.saved').textContent"


@pytest.fixture(params=["chromium", "firefox"])
def keys(request: Any) -> Iterator[Keys]:
    """The keyboard of a browser whose page is still empty."""
    skip_if_missing(axe_core)
    if request.param == "firefox":
        firefox = request.getfixturevalue("firefox")
        firefox.new_tab()
        firefox.resize(1280, 800)
        yield Keys(firefox)
        firefox.close_tab()
        return
    context = request.getfixturevalue("browser").new_context(viewport={"width": 1280, "height": 800})
    page = context.new_page()
    wrong: list[str] = []
    page.on("pageerror", lambda error: wrong.append(str(error)))
    yield Keys(Chromium(page))
    context.close()
    assert wrong == []


@pytest.fixture
def live(jiwy: Any, keys: Keys, target: Target) -> Iterator[Keys]:
    """A page that shows JIWY, which is disabled.  Keys alone have led there."""
    jiwy.epg.post("live/disconnect")
    keys.browser.open(jiwy.address)
    keys.until("document.querySelector('.diagram')")
    keys.tab_to("it.id === 'tab-problems'")
    while keys.it("it.id") != "tab-live":
        keys.press("ArrowRight")
    keys.tab_to("it.id === 'live-port'")
    keys.press("Control+a") if isinstance(keys.browser, Chromium) else keys.it("it.select()")
    keys.type(str(target.port))
    keys.press("Enter")
    keys.until(f"{BAR}.includes('enabled')")
    assert keys.it("it.id") == "panel", "the focus is where the form was"
    keys.press("Escape")
    keys.until(DISABLED)
    keys.tab_to("it.ariaLabel === 'Larger'")
    keys.press("Enter")
    yield keys
    jiwy.epg.post("live/disconnect")


def enable(keys: Keys) -> None:
    keys.until(DISABLED)
    keys.tab_to("it.textContent === 'Enable (hold)'")
    keys.hold("Enter", 0.7)
    keys.until(ENABLED)


def test_live_by_keys(jiwy: Any, live: Keys) -> None:
    keys = live
    keys.walk()
    assert violations_by(keys.evaluate) == []

    # A signal, the movement of an actuator, and a command with a blank, while the robot is disabled.
    keys.tab_to("it.type === 'checkbox'")
    checked = keys.it("it.checked")
    keys.press(" ")
    assert keys.it("it.checked") != checked
    keys.press(" ")
    keys.tab_to("it.ariaLabel === 'Move pwm_pan forwards'")
    position = "document.querySelector('.live-signal .value').textContent"
    before = keys.evaluate(position)
    keys.hold("Enter", 0.8)
    assert keys.evaluate(position) != before
    assert keys.it("it.ariaLabel") == "Move pwm_pan forwards"
    keys.tab_to("it.id === 'live-command'")
    keys.type("get Pan\\PID\\kp")
    assert keys.it("it.value") == "get Pan\\PID\\kp"
    keys.press("Enter")
    keys.until("document.querySelector('.live-console pre').textContent.includes('> get Pan')")

    # Enable by keys keeps the focus; space and Escape stop from everything.
    enable(keys)
    assert keys.it("it.textContent") == "Enable (hold)"
    keys.press("Enter")
    assert keys.it("it.textContent") == "Enable (hold)"
    keys.walk()
    assert keys.evaluate(ENABLED), "Tab does not stop the robot"
    assert violations_by(keys.evaluate) == []
    keys.press("Escape")  # while axe-core works, the page cannot answer
    enable(keys)
    keys.tab_to("it.id === 'setpoint-pan_subscriber'")
    keys.type("0.5")
    keys.press("Enter")
    keys.until("document.querySelector('.live-console pre').textContent.includes('ok setpoint')")
    keys.press(" ")
    keys.until(DISABLED)
    assert keys.it("it.value") == "0.5"
    keys.tab_to("it.textContent === 'Disconnect'")
    keys.press("Enter")
    keys.until("document.getElementById('live-port')")
    assert keys.it("it.id") == "panel"


def test_a_field_that_was_not_sent_is_marked(live: Keys) -> None:
    keys = live
    name = "document.activeElement.getAttribute('aria-labelledby').split(' ')"
    keys.tab_to("it.id === 'setpoint-pan_subscriber'")
    assert keys.evaluate(f"{name}.map((each) => document.getElementById(each).textContent)") == [
        "pan_subscriber",
        "rad",
    ], "the unit belongs to the name"
    keys.tab_to("it.id.startsWith('parameter-') && it.id.includes('kp')")
    value = keys.it("it.value")
    keys.type("2.5")
    assert keys.evaluate("document.querySelectorAll('.unsent').length") == 1
    note = keys.it("document.getElementById(it.getAttribute('aria-describedby').split(' ')[1]).textContent")
    assert note == f"not sent: Enter sends it, Escape restores {value}"
    keys.press("Escape")
    assert (keys.it("it.value"), keys.evaluate("document.querySelectorAll('.unsent').length")) == (value, 0)

    # Above ten times the generated value, the page asks.
    keys.it("it.select()")
    keys.type("1e99")
    keys.press("Enter")
    keys.until("document.querySelector('dialog[open]')?.textContent.includes('becomes 1e+99')")
    keys.tab_to("it.textContent === 'Cancel'")
    keys.press("Enter")
    assert keys.it("it.value") == "1e99"
    assert keys.evaluate("document.querySelectorAll('.unsent').length") == 1, "it was not sent"
    keys.it("it.select()")
    keys.type("2.25")
    keys.press("Enter")
    keys.until("document.querySelectorAll('.unsent').length === 0")
    assert keys.it("it.value") == "2.25"


def test_while_values_are_old_a_disabled_robot_lets_space_type(live: Keys, target: Target) -> None:
    keys = live
    keys.tab_to("it.id === 'live-command'")
    os.kill(target.process.pid, signal.SIGSTOP)
    try:
        keys.until("document.body.classList.contains('old')")
        keys.type("set x=1")
        assert keys.it("it.value") == "set x=1"
        keys.tab_to("it.type === 'checkbox'")
        checked = keys.it("it.checked")
        keys.press(" ")
        assert keys.it("it.checked") != checked
    finally:
        os.kill(target.process.pid, signal.SIGCONT)


def test_wires_by_keys(jiwy: Any, keys: Keys) -> None:
    keys.browser.open(jiwy.address)
    keys.until("document.querySelector('.diagram')")
    keys.walk()
    assert violations_by(keys.evaluate) == []

    # A name that is typed to find an entry of a list is one change.
    keys.tab_to("it.id === 'ends-position_tilt-0'")
    keys.type("encoder_pan")
    keys.press("Enter")
    keys.until("document.getElementById('ends-position_tilt-0').value === ':encoder_pan'")
    keys.until(f"{SAVED}.includes('Unsaved')")
    assert keys.it("it.id") == "ends-position_tilt-0"
    keys.tab_to("it.textContent === 'Undo'")
    keys.press("Enter")
    keys.until(f"{SAVED} === 'Saved'")
    assert jiwy.epg.state()["wires"]["position_tilt"][0]["reference"] == "encoder_tilt"
    assert keys.it("it.textContent") == "Undo", "a button that is disabled now keeps the focus"
    keys.press("Tab")
    assert keys.it("it.textContent") == "Redo"

    # A choice that is not complete is taken back by Escape.
    keys.tab_to("it.id === 'ends-position_tilt-0'")
    keys.type("encoder_p")
    keys.press("Escape")
    assert keys.it("it.value") == ":encoder_tilt"

    # The second end of an output is removed: its list is gone.
    keys.tab_to("it.ariaLabel === 'Connect pwm_pan to another component'")
    keys.press("Enter")
    assert keys.it("it.id") == "ends-pwm_pan-1"
    keys.press("ArrowDown", "Enter")
    keys.until("document.getElementById('ends-pwm_pan-1')?.value.startsWith(':')")
    keys.press("Home", "Enter")
    keys.until("document.getElementById('ends-pwm_pan-1') === null")
    assert keys.it("it.id") == "ends-pwm_pan-0"


def test_a_system_by_keys(keys: Keys, tmp_path: Path) -> None:
    with Served(write_pair(tmp_path / "pair")) as epg:
        keys.browser.open(epg.address)
        keys.until("document.querySelector('.box')")
        keys.walk()
        assert violations_by(keys.evaluate) == []
        keys.tab_to("it.id === 'open-leader'")
        keys.press("Enter")
        keys.until("document.querySelector('.diagram')")
        assert keys.it("it.id") == "main"
        keys.tab_to("it.ariaLabel?.startsWith('Back to the system')")
        keys.press("Enter")
        keys.until("document.activeElement.id === 'open-leader'")


@pytest.mark.parametrize("size", [(1280, 800), (390, 844)], ids=["desktop", "phone"])
def test_live_is_in_sight_at_once_and_after_a_reload(
    jiwy: Any, keys: Keys, target: Target, jiwy_host: Path, size: tuple[int, int]
) -> None:
    keys.browser.resize(*size)
    in_sight = """(() => {
      const { top, bottom } = document.querySelector(".live-head button").getBoundingClientRect();
      return top >= document.getElementById("robot").getBoundingClientRect().bottom && bottom <= innerHeight;
    })()"""
    with Served(jiwy.folder, "--live", "--run", jiwy_host) as epg:
        keys.browser.open(epg.address)
        keys.until("document.querySelector('.live-head')")
        keys.until(in_sight)
    jiwy.epg.post("live/connect", path=str(target.port))
    keys.browser.open(jiwy.address)
    keys.until("document.querySelector('.live-head')")
    keys.until(in_sight)
    keys.walk()
    assert violations_by(keys.evaluate) == []
    jiwy.epg.post("live/disconnect")
