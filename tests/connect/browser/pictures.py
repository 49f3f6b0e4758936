# SPDX-License-Identifier: Apache-2.0
"""Takes the pictures of the page in docs/pictures again; they show the real page, with a real build.

    python -m tests.connect.browser.pictures

This needs the same tools as the tests in this folder, and the Pico SDK.
"""

from __future__ import annotations

import io
import re
import shutil
import subprocess
import tempfile
from pathlib import Path
from typing import Any

from epg.generator.bootstrap import ensure
from tests.doubles.toolchain import arm_gcc, pico_sdk

from .acts import generate, let_pass, until
from .conftest import chromium, copy_jiwy
from .served import ROOT, Served

PICTURES = ROOT / "docs" / "pictures"
COLOURS = 160
SIZE = {"width": 1280, "height": 800}


def take_pictures(folder: Path = PICTURES) -> None:
    """Writes ``connect-*.png``.  Raises Missing without the Pico SDK or its compiler."""
    pico_sdk()
    arm_gcc()
    # The names in the pictures must be the same each time.
    place = Path(tempfile.gettempdir()) / "robots"
    shutil.rmtree(place, ignore_errors=True)
    model = Path(shutil.copytree(ROOT / "examples/jiwy/model", place / "camera_export"))
    with chromium() as launch, Served(model) as epg:
        browser = launch()
        page = browser.new_context(viewport=SIZE, reduced_motion="reduce").new_page()
        page.goto(epg.address)
        _start(page, folder)
        _wires(page, epg, folder)
        _component(page, folder)
        _pins(page, folder)
        _build(page, epg, folder)
        _simulate(page, folder)
        _live(browser, place, folder)
        browser.close()
    shutil.rmtree(place, ignore_errors=True)


def _start(page: Any, folder: Path) -> None:
    page.get_by_role("radio", name="rpi_pico2_bare_metal_jiwy").check()
    until(page, "document.querySelector('.picked-picture')?.naturalWidth > 0")
    until(page, "[...document.images].every((each) => each.complete || each.getBoundingClientRect().top > innerHeight)")
    _take(page, folder, "start")
    page.get_by_role("button", name="Create project").click()
    page.locator(".diagram").wait_for()


def _wires(page: Any, epg: Served, folder: Path) -> None:
    _end(epg, "position_pan", reference="encoder_pan", scale="1/2", limits=["-1", "1"])
    page.get_by_role("button", name="Conversion from encoder_pan to position_pan: ×1/2").click()
    _take(page, folder, "conversion")
    page.keyboard.press("Escape")
    _end(epg, "position_pan", reference="encoder_pan")
    page.get_by_text("No problems", exact=True).wait_for()
    page.evaluate("document.activeElement.blur()")
    _take(page, folder, "wires")
    for port in ("pwm_tilt", "tilt_logging"):
        epg.post("disconnect", port=port)
    page.locator("path.wire.proposed").nth(1).wait_for(state="attached")
    _end(epg, "setpoint_tilt", reference="tilt_subscriber", unit="V")
    _end(epg, "pwm_tilt", reference="pwm_pan")
    page.get_by_text("2 errors").wait_for()
    _take(page, folder, "conflict")
    page.emulate_media(color_scheme="dark")
    page.get_by_role("tab", name="Changes").click()
    _take(page, folder, "dark")
    page.emulate_media(color_scheme="light")
    epg.post("reload")


def _pins(page: Any, folder: Path) -> None:
    page.get_by_role("tab", name="Pinout").click()
    page.get_by_role("button", name="Larger").click()
    page.get_by_label("Signal").select_option("pwm_pan.value")
    page.locator(".pins button").first.wait_for()
    _take(page, folder, "pins")
    page.get_by_role("button", name="Smaller").click()
    page.get_by_role("tab", name="Problems").click()


def _component(page: Any, folder: Path) -> None:
    page.get_by_role("button", name="guard_pan", exact=True).first.click()
    page.get_by_role("button", name="Larger").click()
    page.get_by_label("duty").first.fill("0.4")
    page.get_by_label("duty").first.press("Enter")
    page.get_by_role("button", name="Take duty back to 0.3 (jiwy.tcf)").wait_for()
    page.evaluate("document.activeElement.blur()")
    _take(page, folder, "component")
    page.get_by_role("button", name="Undo").click()
    page.get_by_role("button", name="Smaller").click()
    page.get_by_role("tab", name="Problems").click()


def _build(page: Any, epg: Served, folder: Path) -> None:
    generate(page)
    page.locator(".outcome.done").wait_for(timeout=600_000)
    _take(page, folder, "build")


def _simulate(page: Any, folder: Path) -> None:
    page.get_by_role("button", name="Simulate", exact=True).click()
    page.get_by_role("dialog", name="Run these commands?").get_by_role("button", name="Run").click()
    page.locator(".panel-simulation img.picture").wait_for(timeout=600_000)
    page.get_by_role("button", name="Larger").click()
    _take(page, folder, "simulation")


def _live(browser: Any, place: Path, folder: Path) -> None:
    """The steps of docs/live.md with the example's program, until its gain has been increased."""
    copy_jiwy(place / "jiwy")
    build = place / "jiwy/build"
    subprocess.run(["cmake", "-S", place / "jiwy", "-B", build], check=True, stdout=subprocess.DEVNULL)
    subprocess.run(["cmake", "--build", build, "--target", "jiwy_host"], check=True, stdout=subprocess.DEVNULL)
    with Served(place / "jiwy", "--live", "--run", build / "jiwy_host") as epg:
        page = browser.new_context(viewport=SIZE, reduced_motion="reduce").new_page()
        page.goto(epg.address)
        page.get_by_role("button", name="Enable (hold)").click(delay=700)
        let_pass(page.evaluate, 6.0)
        for name, value, wait in (
            ("pan_subscriber", "1", 2.5),
            ("Pan\\PID\\kp", "0.3", 0.5),
            ("pan_subscriber", "0.5", 2.5),
            ("Pan\\PID\\kp", "2.2", 1.5),
        ):
            field = page.get_by_role("textbox", name=re.compile(f"^{re.escape(name)}( |$)"))
            field.fill(value)
            field.press("Enter")
            let_pass(page.evaluate, wait)
        page.evaluate("document.activeElement.blur()")
        page.locator("#panel").evaluate("panel => panel.scrollTo(0, 0)")
        _take(page, folder, "live")


def _end(epg: Served, port: str, **end: Any) -> None:
    epg.post("connect", port=port, ends=[end])


def _take(page: Any, folder: Path, name: str) -> None:
    """Saves a picture with few colours, so that the repository stays small."""
    ensure("plot")  # this also installs Pillow
    from PIL import Image

    picture = Image.open(io.BytesIO(page.screenshot(animations="disabled"))).convert("RGB")
    reduced = picture.quantize(COLOURS, dither=Image.Dither.NONE)
    reduced.save(folder / f"connect-{name}.png", optimize=True)


if __name__ == "__main__":
    take_pictures()
