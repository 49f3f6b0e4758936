# SPDX-License-Identifier: Apache-2.0
"""From a bare model to a finished program without a pointer; the build is CMake's, for this computer."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

from .acts import tab_to, until
from .served import Served

Open = Callable[..., Any]


def test_everything_by_keyboard(started: Served, model: Path, open_page: Open) -> None:
    page = open_page(started.address)
    page.get_by_role("radio", name="host_jiwy").wait_for()

    tab_to(page, "it.type === 'search'")
    page.keyboard.type("host_jiwy")
    until(page, "document.querySelectorAll('.card').length === 1")
    tab_to(page, "it.type === 'radio'")
    page.keyboard.press("Space")
    tab_to(page, "it.name === 'name'")
    page.keyboard.press("Control+a")
    page.keyboard.type("camera")
    page.keyboard.press("Enter")
    page.locator(".diagram").wait_for()
    folder = Path(started.state()["project"]["folder"])
    assert folder.parent == model.parent

    tab_to(page, "it.textContent === 'Generate'")
    page.keyboard.press("Enter")
    page.get_by_role("dialog", name="Run these commands?").wait_for()
    tab_to(page, "it.textContent === 'Run'")
    page.keyboard.press("Enter")
    page.locator(".outcome:not(.running)").wait_for(timeout=60_000)
    assert started.state()["build"]["state"] == "done", started.state()["build"]
    (product, *_) = started.state()["build"]["products"]
    assert Path(product["path"]).is_file()
    tab_to(page, "it.textContent === 'Copy path'")
    tab_to(page, "it.textContent === 'Close EPG'")
    page.keyboard.press("Enter")
    page.get_by_text("EPG has ended").wait_for()
    assert started.wait() == 0
