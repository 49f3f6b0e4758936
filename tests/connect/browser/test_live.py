# SPDX-License-Identifier: Apache-2.0
"""Live: a running robot in the page is watched, tuned and stopped, and stops when the page is gone."""

from __future__ import annotations

import re
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

from tests.live.target import LATE, LEASE, Target
from tests.waiting import until

from .acts import HOLD, enable, let_pass
from .acts import until as until_page
from .axe import violations
from .served import ROOT, Served

LIVE = (ROOT / "docs" / "live.md").read_text(encoding="utf-8")
Open = Callable[..., Any]
PATIENT = 120_000  # milliseconds for a build on a computer with high load


@pytest.fixture
def page(jiwy: Any, open_page: Open, target: Target) -> Iterator[Any]:
    """A page that shows the target, which is disabled."""
    found = open_page(jiwy.address)
    found.get_by_role("tab", name="Live").click()
    found.get_by_label("Port").fill(str(target.port))
    found.get_by_role("button", name="Connect", exact=True).click()
    found.get_by_role("button", name="Larger").click()
    found.get_by_role("tab", name="Live ● enabled").wait_for()
    found.get_by_role("button", name="Stop robot").click()
    found.get_by_role("tab", name="Live ○ disabled").wait_for()
    yield found
    jiwy.epg.post("live/disconnect")


def stopped(page: Any) -> str:
    """The position at which the axis stands still, in at most 5 s: it coasts, and this computer can be busy."""
    place = page.locator(".live-signals .value").first
    for _ in range(10):
        position = str(place.inner_text())
        let_pass(page.evaluate, 0.5)
        if place.inner_text() == position:
            return position
    raise AssertionError("the axis moves")


def test_a_robot_is_tuned_and_stopped_by_the_space_bar(jiwy: Any, page: Any) -> None:
    enable(page)
    page.get_by_role("textbox", name="pan_subscriber").fill("0.5")
    page.get_by_role("textbox", name="pan_subscriber").press("Enter")
    page.get_by_text("ok setpoint").wait_for()
    page.locator(".live-signals .value").first.filter(has_text=re.compile("^0\\.5")).wait_for()
    assert page.locator(".plots canvas").count() == 1, "the shown signals have one unit"

    # The gain changes while the robot moves, and goes into the bindings.
    gain = page.get_by_role("textbox", name="Pan\\PID\\kp", exact=True)
    gain.fill("2.2")
    gain.press("Enter")
    keep = page.get_by_role("button", name="Keep in the bindings")
    keep.click()
    page.get_by_role("tab", name="Changes ●").wait_for()
    assert "+  'Pan\\PID\\kp': 2.2\n" in jiwy.epg.state()["draft"]["diff"]
    jiwy.epg.post("undo")

    # The space bar stops from any focus, and types and presses nothing.
    for place in (page.get_by_role("textbox", name="tilt_subscriber"), page.get_by_role("button", name="Disconnect")):
        place.focus()
        page.keyboard.press("Space")
        page.get_by_role("tab", name="Live ○ disabled").wait_for()
        assert page.get_by_role("button", name="Stop robot").is_visible()
        if place == page.get_by_role("textbox", name="tilt_subscriber"):
            assert place.input_value() == ""
        enable(page)
    page.get_by_role("button", name="Stop robot").click()

    assert violations(page) == []
    page.set_viewport_size({"width": 400, "height": 700})
    until_page(page, "document.documentElement.scrollWidth <= 400")


def saved(page: Any, part: str, button: str) -> bytes:
    """The file that a button saves."""
    with page.expect_download() as download:
        page.locator(part).get_by_role("button", name=button).click()
    return Path(download.value.path()).read_bytes()


def test_a_step_is_recorded_and_saved(page: Any) -> None:
    page.get_by_label("Trigger").select_option("signal rises to")
    page.get_by_label("Signal", exact=True).select_option("inputs.setpoint_pan")
    for label, text in (("Level", "0.4"), ("Rows before it", "50"), ("Rows", "400")):
        page.get_by_label(label, exact=True).fill(text)
    page.get_by_role("button", name="Record", exact=True).click()
    page.get_by_text("Waiting for the trigger").wait_for()
    assert violations(page) == []
    page.get_by_role("textbox", name="pan_subscriber").fill("0.5")
    page.get_by_role("textbox", name="pan_subscriber").press("Enter")
    page.get_by_role("img", name="Recording of inputs.position_pan").wait_for()
    assert page.get_by_text("400 rows. The trigger is at 0 s.").is_visible()

    # The port of the drawing shows the value.
    page.get_by_role("button", name="Smaller").click()
    port = page.locator(".port", has=page.get_by_text("setpoint_pan", exact=True))
    assert port.locator(".value").inner_text() == "0.5"

    assert saved(page, ".recorded", "Save as CSV").startswith(b"time,inputs.position_pan,")
    assert saved(page, ".live-save", "Save as CSV").startswith(b"time,inputs.position_pan,")
    recorded = page.get_by_text(re.compile(r"^Recorded since [\d:APM ]+: \d+ MB of at most 2000 MB\.$"))
    recorded.wait_for()
    for part in (".recorded", ".live-save"):
        picture = saved(page, part, "Save as PNG")
        assert picture.startswith(b"\x89PNG")
        assert len(picture) > 5000, "there are curves"
    page.get_by_role("button", name="Larger").click()
    page.get_by_text("Loop timing").click()
    longest = page.get_by_role("meter", name="Longest cycle", exact=True)
    assert re.fullmatch(r"[\d.]+ % of the control period", longest.get_attribute("aria-valuetext"))
    assert re.search(r"Cycles\s+\d{3}", page.get_by_role("table").inner_text())
    page.get_by_text(re.compile(r"[\d,]+ cycles, median [\d.]+ µs")).first.wait_for()
    bars = page.get_by_role("img", name="Histogram: Computation of a cycle", exact=True)
    assert bars.locator("rect").count() > 2
    assert violations(page) == []


def test_the_first_three_minutes(jiwy: Any, open_page: Open, jiwy_host: Path) -> None:
    """The steps of docs/live.md with these words.  The CMake target of its step 1 starts the same command."""
    steps = LIVE[LIVE.index("## The first three minutes") : LIVE.index("## In a terminal")]
    with Served(jiwy.folder, "--live", "--run", jiwy_host) as epg:
        page = open_page(epg.address)
        page.get_by_role("tab", name="Live ● enabled").wait_for()  # this program is enabled at its start
        page.keyboard.press("Space")
        page.get_by_role("tab", name="Live ○ disabled").wait_for()

        def fill(name: str, value: str) -> None:
            assert f"`{value}`" in steps and f"`{name}`" in steps
            field = page.get_by_role("textbox", name=re.compile(f"^{re.escape(name)}( |$)"))  # the unit may follow
            field.fill(value)
            field.press("Enter")

        def error() -> float:
            position, setpoint = (
                page.locator(".live-signal", has_text=name).locator(".value").inner_text()
                for name in ("inputs.position_pan", "inputs.setpoint_pan")
            )
            return abs(float(setpoint.split()[0]) - float(position.split()[0]))

        def follows() -> None:
            until(lambda: error() <= 0.006, lambda: page.locator("#panel").inner_text(), pause=0.05)

        enable(page)
        fill("pan_subscriber", "1")
        page.locator(".live-signals .value").first.filter(has_text=re.compile("^1\\.0|^0\\.99")).wait_for(
            timeout=10_000
        )
        follows()
        fill("Pan\\PID\\kp", "0.3")
        fill("pan_subscriber", "0.5")
        let_pass(page.evaluate, 1.0)
        assert error() > 0.015, "it creeps"
        fill("Pan\\PID\\kp", "2.2")
        follows()
        page.keyboard.press("Space")
        page.get_by_role("tab", name="Live ○ disabled").wait_for()
        page.get_by_role("button", name="Keep in the bindings").click()
        page.get_by_role("tab", name="Changes ●").wait_for()
        page.get_by_role("button", name="Save", exact=True).click()
        page.get_by_role("tab", name="Changes", exact=True).wait_for()
        assert "parameters:\n  'Pan\\PID\\kp': 2.2\n" in jiwy.text()
        assert "'Pan\\PID\\kp': 2.2" in steps


def test_stop_is_not_behind_the_streams_of_many_tabs(jiwy: Any, page: Any, target: Target) -> None:
    """A browser opens six connections to a server.  Three tabs that show a target use all of them."""
    page.evaluate(
        "(async () => { const { jsonLines } = await import(new URL('server.js', location));"
        " for (let n = 0; n < 4; n++) jsonLines(`api/live/events?page=${n}`).next(); })()"
    )
    enable(page)
    let_pass(page.evaluate, 1.0)
    assert jiwy.epg.state()["live"]["target"]["state"]["enabled"] == "1", "its numbers are answered"
    page.get_by_role("button", name="Stop robot").click()
    state = jiwy.epg.until(lambda state: state["live"]["target"]["state"]["enabled"] == "0")["live"]["target"]["state"]
    assert state["fault"] == "none", "it was stopped, and not by the end of its lease"


def test_stop_is_in_reach_in_every_tab(jiwy: Any, page: Any) -> None:
    for leave in ("tab", "hide", "another page builds"):
        enable(page)
        if leave == "tab":
            page.get_by_role("tab", name="Problems").click()
        elif leave == "hide":
            page.get_by_role("button", name="Hide details").click()
        else:
            jiwy.epg.generate()
            page.get_by_role("tab", name="Build ").filter(has_text=re.compile("Build .")).wait_for()
            jiwy.epg.post("cancel")
        page.get_by_role("button", name="Stop robot").click()
        page.get_by_role("tab", name="Live ○ disabled").click()
    assert violations(page) == []


def test_an_actuator_moves_while_its_button_is_held(page: Any) -> None:
    button = page.get_by_role("button", name="Move pwm_pan forwards")
    before = page.locator(".live-signals .value").first.inner_text()
    button.click(delay=800)
    assert before != stopped(page)


def test_a_release_is_heard_after_the_page_was_drawn_again(jiwy: Any, page: Any) -> None:
    def press_and_release(button: Any) -> None:
        button.hover()
        page.mouse.down()
        let_pass(page.evaluate, 0.15)
        jiwy.epg.post("reload")
        let_pass(page.evaluate, 0.15)
        page.mouse.up()

    press_and_release(page.get_by_role("button", name="Enable (hold)"))
    let_pass(page.evaluate, HOLD / 1000)
    assert page.get_by_role("tab", name="Live ○ disabled").is_visible(), "the press was too short"
    press_and_release(page.get_by_role("button", name="Move pwm_pan forwards"))
    assert stopped(page)


def test_a_page_that_is_hidden_stops_the_robot(jiwy: Any, page: Any, target: Target) -> None:
    """test_failures.py kills pages."""
    enable(page)
    let_pass(page.evaluate, 1.0)
    assert jiwy.epg.state()["live"]["target"]["state"]["enabled"] == "1"
    page.evaluate("Object.defineProperty(document, 'hidden', {value: true})")
    at = time.monotonic()  # the page's end, compared with the target's time
    until(lambda: jiwy.epg.state()["live"]["target"]["state"]["enabled"] == "0")
    assert jiwy.epg.state()["live"]["target"]["state"]["fault"] == "operator"
    jiwy.epg.post("live/disconnect")
    assert target.last_enabled() <= at + LEASE + LATE


def test_a_program_that_the_page_runs_is_compared_with_its_simulation(jiwy: Any, open_page: Open) -> None:
    page = open_page(jiwy.address)

    def press(name: str, action: str, job: str) -> None:
        """Presses a button, and agrees to run commands if the page asks."""
        with page.expect_response(re.compile(f"/api/{action}$"), timeout=PATIENT) as answer:
            page.get_by_role("button", name=name).click(timeout=PATIENT)
        if answer.value.json()[job]["ask"]:
            page.get_by_role("dialog", name="Run these commands?").get_by_role("button", name="Run").click()

    press("Generate", "generate", "build")
    press("Run jiwy_host in real time", "run", "program")
    page.get_by_text("jiwy_host runs in real time").wait_for()
    page.get_by_role("tab", name="Live").click()
    page.get_by_role("button", name="Connect", exact=True).click()
    page.get_by_role("button", name="Larger").click()
    page.get_by_role("button", name="Stop robot").click()
    page.get_by_role("tab", name="Live ○ disabled").wait_for()
    enable(page)
    let_pass(page.evaluate, 3.0)  # it is homing
    page.get_by_role("textbox", name="pan_subscriber").fill("0.5")
    page.get_by_role("textbox", name="pan_subscriber").press("Enter")
    let_pass(page.evaluate, 1.5)
    page.get_by_role("button", name="Stop robot").click()
    press("Compare", "compare", "comparison")
    page.get_by_role("img", name="Target and simulation: inputs.position_pan").wait_for(timeout=PATIENT)
    difference = page.get_by_text("inputs.position_pan simulated, RMS difference").inner_text()
    assert float(difference.split()[-2]) < 0.1
    assert violations(page) == []
    assert jiwy.epg.state()["program"]["state"] == "running", "the comparison has not ended the program"
    jiwy.epg.post("live/disconnect")
    jiwy.epg.post("cancel")


def test_enable_shows_where_the_robot_will_move_and_a_refused_setpoint_its_limits(page: Any) -> None:
    field = page.get_by_role("textbox", name="pan_subscriber")
    field.fill("0.5")
    field.press("Enter")
    page.get_by_text("ok setpoint").wait_for()
    page.get_by_role("button", name="Enable (hold)").hover()
    page.locator("#enable-goals", has_text="will move to 0.5 rad (pan_subscriber)").wait_for()
    limits = page.locator(".field", has=page.get_by_text("pan_subscriber", exact=True)).locator(".hint").inner_text()
    assert limits == "-0.05 to 3.2 rad"
    field.fill("-0.5")
    field.press("Enter")
    page.get_by_text("pan_subscriber must be from -0.05 to 3.2 rad").first.wait_for()


COLOURS = """async () => {
  const { colour, dash } = await import(new URL("plots.js", location));
  const part = (hex) => parseInt(hex, 16) / 255;
  const linear = (value) => value <= 0.04045 ? value / 12.92 : ((value + 0.055) / 1.055) ** 2.4;
  const luminance = (hex) => [0.2126, 0.7152, 0.0722]
    .reduce((sum, weight, n) => sum + weight * linear(part(hex.slice(1 + 2 * n, 3 + 2 * n))), 0);
  const contrast = (one, other) => {
    const [low, high] = [luminance(one), luminance(other)].sort((a, b) => a - b);
    return (high + 0.05) / (low + 0.05);
  };
  const surface = getComputedStyle(document.documentElement).getPropertyValue("--surface").trim();
  const all = Array.from({ length: 32 }, (_, index) => index);
  return [
    Math.min(...all.map((index) => contrast(colour(index), surface))),
    new Set(all.map((index) => colour(index) + dash(index))).size,
  ];
}"""


def test_curves_can_be_distinguished_and_plots_have_names(page: Any) -> None:
    """A program has at most 32 signals.  Lines need a contrast of 3 to their background (WCAG 1.4.11)."""
    for scheme in ("light", "dark"):
        page.emulate_media(color_scheme=scheme)
        contrast, lines = page.evaluate(COLOURS)
        assert contrast >= 3, scheme
        assert lines == 32
    name = "Plot in rad of the last 10 s: inputs.position_pan, inputs.position_tilt, inputs.setpoint_pan"
    page.get_by_role("img", name=re.compile(f"^{re.escape(name)}")).wait_for()
    box = page.get_by_role("checkbox", name="inputs.position_pan", exact=True)  # without the value
    assert box.is_checked()


def test_a_file_that_is_not_complete_is_explained(jiwy: Any, page: Any) -> None:
    """While EPG makes a file, the page says so, and after a reload and a lost connection that the file is missing."""
    page.route("**/api/live/save?*as=mcap", lambda route: None)  # it takes long
    page.get_by_role("button", name="Save as MCAP").click()
    page.get_by_text("If its package for MCAP is not installed, EPG installs it first").wait_for()
    page.reload()
    page.get_by_text("The page was loaded again before jiwy.mcap was complete").wait_for()
    page.unroute("**/api/live/save?*as=mcap")
    page.route("**/api/live/save?*as=mcap", lambda route: route.abort("connectionrefused"))
    page.get_by_role("button", name="Save as MCAP").click()
    page.get_by_text("EPG has ended while it made jiwy.mcap").wait_for()
    assert page.get_by_text("EPG makes the file").count() == 0
    assert page.get_by_text("The page was loaded again").count() == 0
