# SPDX-License-Identifier: Apache-2.0
"""A page without its server reports this, keeps its contents, and continues when the server is back."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

from .acts import field, until
from .conftest import Project, copy_jiwy
from .served import Served

Open = Callable[..., Any]


def test_says_that_the_connection_is_lost(browser: Any, open_page: Open, tmp_path: Path) -> None:
    copy_jiwy(tmp_path / "jiwy")
    with Served(tmp_path / "jiwy") as epg:
        page = open_page(epg.address)
        field(page, "position_tilt").select_option("encoder_pan")
        page.get_by_text("● Unsaved").wait_for()
    page.get_by_role("alert").get_by_text("The connection to EPG is lost.").wait_for()
    assert "epg connect" in page.get_by_role("alert").inner_text()
    assert field(page, "position_tilt").is_visible(), "what was on the page stays to be read"

    # The browser asks a user who leaves with unsaved changes.
    with page.expect_event("dialog") as leaving:
        page.close(run_before_unload=True)
    assert leaving.value.type == "beforeunload"
    leaving.value.accept()


def test_asks_before_changes_are_lost(browser: Any, open_page: Open, tmp_path: Path) -> None:
    copy_jiwy(tmp_path / "jiwy")
    file = tmp_path / "jiwy/jiwy.bindings.yaml"
    with Served(tmp_path / "jiwy") as epg:
        page = open_page(epg.address)
        field(page, "position_tilt").select_option("encoder_pan")
        page.get_by_text("● Unsaved").wait_for()
        page.get_by_role("button", name="Close EPG").click()
        dialog = page.get_by_role("dialog", name="Close EPG")
        dialog.get_by_role("button", name="Cancel").click()
        assert epg.state()["draft"]["changed"]
        page.get_by_role("button", name="Close EPG").click()
        dialog.get_by_role("button", name="Save and close").click()
        page.get_by_text("EPG has ended").wait_for()
    assert "  position_tilt: encoder_pan\n" in file.read_text()


def test_goes_on_when_the_connection_is_back(jiwy: Project, open_page: Open) -> None:
    page = open_page(jiwy.address)
    page.context.set_offline(True)
    jiwy.epg.post("connect", port="position_tilt", ends=[{"reference": "encoder_pan"}])
    lost = page.get_by_role("alert").get_by_text("The connection to EPG is lost.")
    lost.wait_for()
    jiwy.epg.post("connect", port="setpoint_tilt", ends=[{"reference": "pan_subscriber"}])
    page.context.set_offline(False)
    lost.wait_for(state="detached")
    until(page, "document.getElementById('ends-setpoint_tilt-0').value === ':pan_subscriber'")
