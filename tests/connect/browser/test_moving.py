# SPDX-License-Identifier: Apache-2.0
"""The dialog that moves a project to another board lists all changes first; by keyboard, in a narrow window, too."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from tests.connect.test_moving import write_axis
from tests.doubles.toolchain import Missing

from .acts import until
from .axe import violations
from .served import Served

Open = Callable[..., Any]


def test_to_another_board_by_keyboard(browser: Any, open_page: Open, tmp_path: Path) -> None:
    folder = write_axis(tmp_path)
    before = (folder / "CMakeLists.txt").read_text()
    with Served(folder) as served:
        page = open_page(served.address)
        until(page, "document.querySelector('.target')?.disabled === false", 20)
        page.get_by_role("button", name="Target").focus()
        page.keyboard.press("Enter")
        page.get_by_role("radio", name="nucleo_h743zi_freertos").focus()
        page.keyboard.press("Space")
        page.get_by_role("button", name="Show changes").focus()
        page.keyboard.press("Enter")
        dialog = page.get_by_role("dialog")
        dialog.get_by_role("heading", name="From rpi_pico2_bare_metal to nucleo_h743zi_freertos").wait_for(
            timeout=20000
        )
        assert page.evaluate("document.activeElement.id") == "move-title"
        assert "Disconnect the motor supply" in dialog.inner_text()
        assert "GP10 → " in dialog.get_by_role("region", name="Changed").inner_text()
        assert "clocks.sys" in dialog.get_by_role("region", name="Dropped").inner_text()
        assert "components.encoder" in dialog.get_by_role("region", name="Kept").inner_text()
        for width, height in ((1280, 800), (400, 800)):
            page.set_viewport_size({"width": width, "height": height})
            assert page.evaluate("document.querySelector('dialog').scrollWidth") <= width
            try:
                assert violations(page) == []
            except Missing as reason:
                pytest.skip(str(reason))
        page.set_viewport_size({"width": 1280, "height": 800})
        dialog.get_by_role("button", name="Change target").focus()
        page.keyboard.press("Enter")
        page.get_by_text("● Unsaved").wait_for(timeout=20000)
        assert "nucleo_h743zi_freertos" in page.locator(".target").inner_text()
        page.keyboard.press("Control+s")
        page.get_by_text("Saved", exact=True).wait_for()
        assert "epg_import_stm32()" in (folder / "CMakeLists.txt").read_text()
        page.keyboard.press("Control+z")
        page.get_by_text("● Unsaved").wait_for()
        page.keyboard.press("Control+s")
        page.get_by_text("Saved", exact=True).wait_for()
        assert (folder / "CMakeLists.txt").read_text() == before
