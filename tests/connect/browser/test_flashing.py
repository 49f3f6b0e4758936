# SPDX-License-Identifier: Apache-2.0
"""Flash on the page: the board is looked for, named and confirmed before anything is written."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from tests.connect.page import serving_addresses, session_of
from tests.connect.test_flashing import attach, built, drive, pico, plug, restarting, robot, tools
from tests.system.test_flash import FIRST, SECOND

from .axe import violations

Open = Callable[..., Any]
__all__ = ["tools"]


def test_a_board_is_named_and_confirmed(open_page: Open, tools: Path, tmp_path: Path) -> None:
    _, made = robot(tmp_path)
    session = session_of(tmp_path / "robot")
    built(session, made)
    with serving_addresses(session) as new_address:
        page = open_page(new_address())
        page.get_by_role("tab", name="Build").click()
        page.get_by_role("button", name="Flash").click()
        dialog = page.get_by_role("dialog", name="Write the firmware to a board?")
        dialog.get_by_text("No board was found.").wait_for()
        dialog.get_by_text("Hold BOOTSEL while you plug it in, and look again").wait_for()

        # Two boards: the user must choose.
        attach(tmp_path, pico(FIRST, "leader"), pico(SECOND))
        plug(tmp_path, "1-1", "2e8a:000a", FIRST, "Pico", "4")
        plug(tmp_path, "1-2", "2e8a:000a", SECOND, "Pico", "5")
        dialog.get_by_role("button", name="Look again").click()
        write = dialog.get_by_role("button", name="Write to this board")
        dialog.get_by_text("2 boards are connected.").wait_for()
        assert write.is_disabled() and violations(page) == []
        assert dialog.get_by_text("File: ").count() == 0, "each board can get another file"
        dialog.get_by_label(f"Pico {FIRST}").check()
        assert dialog.get_by_text("File: ").inner_text() == "File: build/robot_firmware.elf"
        write.click()
        panel = page.get_by_role("tabpanel")
        panel.get_by_text("has the program of the target 'leader'").wait_for()
        panel.get_by_role("button", name="Replace the other program …").click()
        dialog.get_by_label(f"Pico {FIRST}").check()
        dialog.get_by_role("button", name="Replace the other program").click()
        panel.get_by_text(f"Wrote robot_firmware.elf to Pico {FIRST}.").wait_for()

        # A board in BOOTSEL mode with its drive needs no tool.
        folder = drive(tmp_path, "RPI-RP2", "RPI-RP2")
        page.get_by_role("button", name="Flash").click()
        dialog.get_by_text(f"RPI-RP2, the drive {folder}").wait_for()
        dialog.get_by_text("Disconnect the supply of the motors first.").wait_for()
        assert "build/robot_firmware.uf2" in dialog.inner_text() and not list(folder.glob("*.uf2"))
        dialog.get_by_role("button", name="Write to this board").click()
        restarting(folder)()
        panel.get_by_text(f"Wrote robot_firmware.uf2 to RPI-RP2, the drive {folder}.").wait_for()
        assert violations(page) == []


@pytest.mark.usefixtures("tools")
def test_a_program_for_this_computer_has_no_flash(open_page: Open, tmp_path: Path) -> None:
    _, made = robot(tmp_path, "host_jiwy")
    session = session_of(tmp_path / "robot")
    built(session, made, runs=True)
    with serving_addresses(session) as new_address:
        page = open_page(new_address())
        page.get_by_role("tab", name="Build").click()
        page.get_by_role("button", name="Run robot_firmware.elf in real time").wait_for()
        assert page.get_by_role("button", name="Flash").count() == 0
