# SPDX-License-Identifier: Apache-2.0
"""The page in Firefox: from a model to a project, wires by mouse and keyboard, pins, pictures, a build."""

from __future__ import annotations

import secrets
from pathlib import Path

import pytest

from .conftest import copy_jiwy
from .firefox import Firefox
from .served import Served


def handle(side: str, name: str) -> str:
    return f'[data-handle][data-side="{side}"][data-name="{name}"]'


def chosen(port: str) -> str:
    return f"document.querySelector('.ports .port[data-name=\"{port}\"] select').value"


def test_a_project_its_wires_and_its_pins(firefox: Firefox, model: Path) -> None:
    with Served(model) as epg:
        firefox.open(epg.address)
        firefox.click("#target-rpi_pico_bare_metal_jiwy")
        firefox.until("document.querySelector('.picked-picture')?.naturalWidth > 0")
        firefox.click("::-p-aria(Create project)")
        firefox.until("document.querySelectorAll('.wire-group').length === 10")
        assert firefox.evaluate("document.title") == "camera_project – EPG"

        # With the mouse: a wire is moved to another component, and removed with Undo.
        epg.post("disconnect", port="position_tilt")
        firefox.until(f"{chosen('position_tilt')} === ''")
        firefox.drag(handle("sources", "encoder_tilt"), handle("inputs", "position_tilt"))
        firefox.until(f"{chosen('position_tilt')} === ':encoder_tilt'")
        firefox.until("document.querySelectorAll('.wire-group').length === 10")

        # With the keyboard: the wire goes to the other encoder.
        firefox.focus(handle("inputs", "position_tilt"))
        firefox.press("Delete")
        firefox.until(f"{chosen('position_tilt')} === ''")
        firefox.press("Enter", "End")
        assert firefox.evaluate("document.activeElement.dataset.side") == "sources"
        firefox.focus(handle("sources", "encoder_tilt"))
        firefox.press("Enter")
        firefox.until(f"{chosen('position_tilt')} === ':encoder_tilt'")

        # A list at a port, with keys.
        firefox.focus("#ends-position_tilt-0")
        firefox.type("encoder_pan")
        firefox.press("Enter")
        firefox.until(f"{chosen('position_tilt')} === ':encoder_pan'")

        firefox.click("#tab-hardware")
        rows = firefox.evaluate("[...document.querySelectorAll('#panel tbody tr')].map((row) => row.textContent)")
        assert len(rows) == len(epg.state()["hardware"]) and any("GP10" in row for row in rows)
        # A signal is dragged to another contact of the board's drawing.
        firefox.click("#tab-wiring")
        firefox.resize(1280, 1600)
        firefox.drag(".board >>> [data-signal='pwm_pan.value']", ".board >>> [data-pin='GP3']")
        firefox.until("document.getElementById('pin-signal').selectedOptions[0].text === 'pwm_pan value: GP3'")
        firefox.click("::-p-aria(Undo)")
        firefox.until("document.getElementById('pin-signal').selectedOptions[0].text === 'pwm_pan value: GP2'")
        firefox.resize(1280, 800)
        for name in ("application", "schedule"):
            firefox.click(f"#tab-{name}")
            firefox.until("document.querySelector('#panel img.picture')?.naturalWidth > 200")
        fill = "getComputedStyle(document.querySelector('svg rect.back')).fill"
        assert firefox.follow("#panel a[target=_blank]", fill) == "rgb(255, 255, 255)", (
            "the picture alone has its style"
        )
        firefox.click("#tab-changes")
        assert "+  position_tilt: encoder_pan" in firefox.evaluate("document.querySelector('.diff').textContent")
        firefox.click("::-p-aria(Save)")
        firefox.until("document.querySelector('.saved').textContent === 'Saved'")
        firefox.resize(400, 800)
        assert firefox.evaluate("document.documentElement.scrollWidth <= document.documentElement.clientWidth")
        bindings = model.parent / "camera_project/camera_project.bindings.yaml"
        assert "  position_tilt: encoder_pan\n" in bindings.read_text(encoding="utf-8")


@pytest.mark.parametrize("mistake", ["", 'message(FATAL_ERROR "not today")\n'], ids=["build", "mistake"])
def test_generate(mistake: str, firefox: Firefox, tmp_path: Path) -> None:
    folder = tmp_path / secrets.token_hex(4)
    copy_jiwy(folder)
    cmake = folder / "CMakeLists.txt"
    cmake.write_text(mistake + cmake.read_text(encoding="utf-8"), encoding="utf-8")
    with Served(folder) as epg:
        firefox.open(epg.address)
        firefox.click("::-p-aria(Generate)")
        firefox.until("document.querySelector('dialog[open] pre')?.textContent.includes('cmake -S')")
        firefox.click("dialog .primary")
        if mistake:
            firefox.until("document.querySelector('.outcome.failed')", 60)
            firefox.click(".problem-list .problem")
            firefox.until("document.querySelector('dialog .line.here')?.textContent.includes('not today')")
            firefox.press("Escape")
            firefox.click("details.log summary")
            firefox.until("document.querySelector('.log pre').textContent.includes('not today')")
            return
        firefox.until("document.querySelector('.outcome.done')", 120)
        paths = firefox.evaluate("[...document.querySelectorAll('.product-path code')].map((each) => each.textContent)")
        assert paths and all(Path(path).is_file() for path in paths)
