# SPDX-License-Identifier: Apache-2.0
"""Generate: a real build for this computer, its progress, its products and its errors."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from tests.connect.robots import new_project

from .acts import field, run_program, until
from .conftest import Project
from .served import Served

Open = Callable[..., Any]
PATIENT = 60_000  # milliseconds for a build on a computer with high load


def test_generates_shows_errors_and_cancels(jiwy: Project, open_page: Open) -> None:
    page = open_page(jiwy.address)
    source = jiwy.folder / "model" / "xxsubmod.c"
    original = source.read_text(encoding="utf-8")
    generate = page.get_by_role("button", name="Generate", exact=True)
    panel = page.get_by_role("tabpanel")

    # With a mistake in the bindings there is no build; the page gives the reason and shows the list.
    field(page, "setpoint_pan").select_option("")
    page.get_by_text("1 error", exact=True).wait_for()
    generate.click()
    page.get_by_role("alert").get_by_text("the project cannot be built").wait_for()
    assert page.get_by_role("tab", name="Problems").get_attribute("aria-selected") == "true"
    field(page, "setpoint_pan").select_option("pan_subscriber")
    page.get_by_text("No problems", exact=True).wait_for()

    # A compiler's error links to its line.
    source.write_text(original + "\nint broken = nowhere;\n", encoding="utf-8")
    line = original.count("\n") + 2
    # Before the first build in a folder, the page shows the commands that will run there.
    generate.click()
    asked = page.get_by_role("dialog", name="Run these commands?")
    assert f"cmake -S {jiwy.folder} -B {jiwy.folder}/build" in asked.locator("pre").inner_text()
    assert asked.locator("pre").evaluate("it => it.scrollWidth <= it.clientWidth"), "commands are in sight as a whole"
    assert asked.evaluate("it => it.scrollWidth <= it.clientWidth")
    page.keyboard.press("Escape")
    assert jiwy.epg.state()["build"]["state"] == "idle" and not (jiwy.folder / "build").exists()
    generate.click()
    asked.get_by_role("button", name="Run").click()
    page.get_by_role("progressbar").wait_for()
    assert asked.count() == 0
    page.get_by_role("button", name="Cancel", exact=True).wait_for()
    page.locator(".outcome.failed").wait_for(timeout=PATIENT)
    panel.get_by_text("nowhere").first.click()
    dialog = page.get_by_role("dialog")
    assert dialog.locator(".line.here").first.inner_text().startswith(f"> {line}  int broken = nowhere;")
    page.keyboard.press("Escape")

    # After the correction: progress with a known end, and a product.
    source.write_text(original, encoding="utf-8")
    page.evaluate(
        "(() => { window.seen = []; new MutationObserver(() => { const bar = document.querySelector('progress');"
        " if (bar) seen.push([bar.value, bar.max]); }).observe(document.getElementById('dock'),"
        " {subtree: true, childList: true, attributes: true}); })()"
    )
    generate.click()
    page.locator(".outcome.done").wait_for(timeout=PATIENT)
    assert any(0 < value <= most and most > 1 for value, most in page.evaluate("seen"))
    build = jiwy.epg.state()["build"]
    for product in build["products"]:
        assert Path(product["path"]).is_file()
        assert panel.get_by_text(product["path"], exact=True).is_visible()
        assert panel.get_by_text(product["what"], exact=True).first.is_visible()
    panel.get_by_role("button", name="Copy").first.click()
    panel.get_by_text("Copied").wait_for()
    panel.get_by_text("Log,").click()
    until(page, f"document.querySelector('.log pre').textContent.split('\\n').length >= {build['lines']}")

    # The program runs in real time until it is stopped, and is downloaded.
    run_program(page, "jiwy_host")
    assert panel.get_by_role("button", name="Run jiwy_host in real time").is_disabled()
    generate.click()  # beside the program
    page.get_by_role("button", name="Cancel", exact=True).wait_for()
    page.get_by_role("button", name="End program", exact=True).wait_for(timeout=PATIENT)
    page.get_by_role("button", name="End program", exact=True).click()
    panel.get_by_text("jiwy_host was stopped.").wait_for(timeout=PATIENT)
    panel.get_by_text("Output,").click()
    panel.get_by_label("Output").get_by_text("interrupted").wait_for()
    with page.expect_download() as download:
        panel.get_by_role("button", name="Download jiwy_host").click()
    assert download.value.suggested_filename == "jiwy_host"
    assert download.value.path().read_bytes() == (jiwy.folder / "build/jiwy_host").read_bytes()

    # A build of everything that is cancelled at once.
    source.write_text(original + "\n", encoding="utf-8")
    generate.click()
    page.get_by_role("button", name="Cancel", exact=True).click()
    page.locator(".outcome.cancelled", has_text="Cancelled.").wait_for(timeout=PATIENT)  # beside that of the program
    source.write_text(original, encoding="utf-8")


def test_missing_tools_come_with_their_commands_at_once(
    open_page: Open, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("HOME", str(tmp_path / "home"))
    monkeypatch.setenv("EPG_CACHE", str(tmp_path / "cache"))
    monkeypatch.delenv("PICO_SDK_PATH", raising=False)
    folder = tmp_path / "robot"
    new_project(folder, "rpi_pico_freertos_jiwy")
    with Served(folder) as epg:
        page = open_page(epg.address, permissions=["clipboard-read", "clipboard-write"])
        page.get_by_role("button", name="Generate", exact=True).click()
        page.locator(".outcome.failed").wait_for()
        panel = page.get_by_role("tabpanel")
        for name in ("FreeRTOS kernel", "Raspberry Pi Pico SDK"):
            panel.get_by_text(f"{name} was not found").wait_for()
        assert page.get_by_role("dialog").count() == 0 and not (folder / "build").exists()
        panel.locator("li", has_text="Pico SDK").get_by_role("button", name="Copy command").click()
        copied = page.evaluate("navigator.clipboard.readText()")
        assert copied.startswith("git clone ") and copied.endswith(f"{tmp_path}/cache/pico-sdk-2.2.0")
        panel.get_by_role("button", name="Build anyway").click()
        page.get_by_role("dialog", name="Run these commands?").wait_for()
