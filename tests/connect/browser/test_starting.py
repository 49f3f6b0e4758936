# SPDX-License-Identifier: Apache-2.0
"""From a bare model to a project: choose, create, connect."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

from .acts import field, until
from .served import Served

Open = Callable[..., Any]


def test_from_model_to_project(started: Served, model: Path, open_page: Open) -> None:
    page = open_page(started.address)
    assert page.locator(".step-model .big").inner_text() == "JIWY_Control"
    create = page.get_by_role("button", name="Create project")
    page.get_by_role("radio", name="host_jiwy").wait_for()
    assert not create.is_enabled()

    # Search and filter leave only matching cards.
    everything = page.locator(".card").count()
    assert everything == len(started.state()["configurations"])
    page.get_by_label("Search").fill("pico 2 freertos")
    names = page.locator(".card .name").all_inner_texts()
    assert names and all("pico2" in name and "freertos" in name for name in names)
    page.get_by_label("Search").fill("nothing like it")
    page.get_by_text("No target matches").wait_for()
    page.get_by_label("Search").fill("")
    page.get_by_label("Robot", exact=True).select_option("jiwy")
    assert {card.split("_")[-1] for card in page.locator(".card .name").all_inner_texts()} == {"jiwy"}

    # A card shows the contents of its configuration.
    card = page.locator(".card").filter(has=page.get_by_text("rpi_pico_bare_metal_jiwy", exact=True))
    assert "10 of 10 ports match by name" in card.inner_text()
    card.scroll_into_view_if_needed()  # a picture is fetched when it becomes visible
    until(page, "[...document.querySelectorAll('.card img')].some(image => image.naturalWidth > 0)")

    page.get_by_role("radio", name="rpi_pico_bare_metal_jiwy").check()
    name_field, folder_field = (page.get_by_role("textbox", name=name) for name in ("Name", "Folder"))
    name_field.fill("pan_tilt")
    assert folder_field.input_value() == str(model.parent / "pan_tilt"), "the folder has the name of the project"
    folder = model.parent / "my camera"
    folder_field.fill(str(folder))
    name_field.fill("1 camera")
    assert folder_field.input_value() == str(folder), "the user's own folder stays"
    create.click()
    page.get_by_role("alert").wait_for()  # this is not a valid name of a CMake target
    assert not folder.exists()
    page.get_by_role("textbox", name="Name").fill("camera")
    create.click()
    page.locator(".diagram").wait_for()
    assert page.get_by_role("heading", level=1).inner_text() == "camera"
    assert (folder / "CMakeLists.txt").is_file()

    # Ports with matching names are connected, and the board is shown.
    assert field(page, "position_pan").input_value() == ":encoder_pan"
    page.get_by_role("tab", name="Pins and peripherals").click()
    table = page.get_by_role("table")
    assert table.locator("tbody tr").count() == len(started.state()["hardware"])
    assert "GP10" in table.inner_text()
    page.get_by_role("tab", name="Pinout").click()
    picture = page.get_by_role("tabpanel").get_by_role("img")
    picture.locator("desc").wait_for(state="attached")
    assert "encoder_pan a to contact 14 (GP10); encoder_pan b to contact 15 (GP11)" in picture.text_content()

    # Another target: the page lists the changes before it makes them.
    page.get_by_role("button", name="Target").click()
    dialog = page.get_by_role("dialog")
    dialog.get_by_label("Robot", exact=True).select_option("relbot")
    dialog.get_by_role("radio", name="rpi_pico_bare_metal_relbot").check()
    dialog.get_by_role("button", name="Show changes").click()
    assert "rpi_pico_bare_metal_relbot.tcf" in dialog.get_by_role("region", name="Changed").inner_text()
    dialog.get_by_role("button", name="Change target").click()
    page.get_by_text("● Unsaved").wait_for()
    page.locator(".component-name").get_by_text("encoder_left", exact=True).first.wait_for()
    page.get_by_role("tab", name="Changes").click()
    assert "+extends: rpi_pico_bare_metal_relbot.tcf" in page.get_by_role("tabpanel").inner_text()
    page.keyboard.press("Control+z")
    page.locator(".component-name").get_by_text("encoder_pan", exact=True).first.wait_for()
