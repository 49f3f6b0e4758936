# SPDX-License-Identifier: Apache-2.0
"""Simulate: from an export of a known robot to a simulated robot that moves, and what the page shows of it."""

from __future__ import annotations

import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

from .axe import violations
from .served import ROOT, Served

Open = Callable[..., Any]
PATIENT = 120_000  # milliseconds for a build on a computer with high load


class Clicks:
    """Clicks, and their number."""

    def __init__(self) -> None:
        self.number = 0

    def on(self, place: Any) -> None:
        place.click()
        self.number += 1


def test_from_an_export_to_a_moving_robot_in_four_clicks(open_page: Open, tmp_path: Path) -> None:
    """The export of RELbot has ports whose names are not those of the components: EPG proposes their wires."""
    export = Path(shutil.copytree(ROOT / "examples/relbot/model", tmp_path / "exports" / "relbot_export"))
    clicks = Clicks()
    with Served(export) as epg:
        page = open_page(epg.address)
        clicks.on(page.locator(".card", has=page.get_by_text("rpi_pico2_freertos_relbot", exact=True)))
        clicks.on(page.get_by_role("button", name="Create project"))
        clicks.on(page.get_by_role("button", name="Simulate", exact=True))
        asked = page.get_by_role("dialog", name="Run these commands?")
        commands = asked.get_by_label("Commands").inner_text()
        assert " --build " in commands and " simulate " in commands.splitlines()[-1]
        assert "PosLeft – encoder_left" in asked.inner_text()
        folder = Path(epg.state()["project"]["folder"])
        bindings = folder / f"{epg.state()['project']['name']}.bindings.yaml"
        assert "\n  PosLeft: encoder_left" not in bindings.read_text(), "no proposal is saved unasked"
        assert not (folder / "simulation/build").exists()
        clicks.on(asked.get_by_role("button", name="Connect and run"))
        assert clicks.number == 4
        panel = page.get_by_role("tabpanel")
        page.locator(".outcome.done").wait_for(timeout=PATIENT)
        assert page.get_by_role("tab", name="Simulation ✓").get_attribute("aria-selected") == "true"
        panel.get_by_text("Done. The robot has moved as the scenario expects.").wait_for()
        plot = panel.locator("img.picture")
        plot.wait_for()
        assert "largest error" in plot.get_attribute("alt")
        assert plot.evaluate("async (image) => { await image.decode(); return image.naturalWidth; }") > 600
        assert panel.get_by_role("row").count() == 3, "a line for each axis"
        assert epg.state()["draft"]["external"] is None, "the new build folder is no edit of the project"

        assert violations(page) == []
        page.set_viewport_size({"width": 400, "height": 700})
        wide = page.evaluate("document.documentElement.scrollWidth")
        assert wide <= 400, f"the page is {wide} px wide"
        page.set_viewport_size({"width": 1280, "height": 800})

        # The robot has moved, and only in the simulation: no file enables the target.
        rows = (folder / "simulation/build/tracking.csv").read_text().splitlines()
        column = rows[0].split(",").index("left_subscriber_position")
        assert abs(float(rows[-1].split(",")[column]) - 0.3) < 0.02
        tcf = bindings.with_name(bindings.name.replace(".bindings.yaml", ".tcf")).read_text()
        assert "enable_at_start: false" in tcf

        # A limit that does not hold is shown as such.
        scenario = folder / "simulation/scenario.yaml"
        text = scenario.read_text()
        scenario.write_text(text.replace("    unit", "    windows: [{from: 6 s, until: 9 s, rms: 0.001}]\n    unit", 1))
        if "windows: [{from: 6 s, until: 9 s, rms: 0.001}]\n    unit" not in scenario.read_text():
            scenario.write_text(f"{text.rstrip()}\n    windows: [{{from: 6 s, until: 9 s, rms: 0.001}}]\n")
        page.get_by_role("button", name="Simulate", exact=True).click()
        panel.get_by_text("does not hold", exact=True).wait_for(timeout=PATIENT)
        panel.get_by_text("Done. The scenario's expectations do not hold.").wait_for()

        # A mistake in the scenario is shown before anything is built.
        scenario.write_text(text.replace("duration: 9 s", "duration: 9 apples"))
        page.get_by_role("button", name="Simulate", exact=True).click()
        panel.locator(".problem-list").get_by_text("apples").first.wait_for()
        assert page.get_by_role("tab", name="Simulation ✕").is_visible()


def test_a_simulation_is_stopped(open_page: Open, tmp_path: Path) -> None:
    export = Path(shutil.copytree(ROOT / "examples/jiwy/model", tmp_path / "exports" / "jiwy_export"))
    with Served(export) as epg:
        page = open_page(epg.address)
        epg.post("create", configuration="host_jiwy", folder=str(tmp_path / "robot"), name="robot")
        page.get_by_role("button", name="Simulate", exact=True).click()
        page.get_by_role("dialog").get_by_role("button", name="Run", exact=True).click()
        page.get_by_role("progressbar").wait_for()
        page.get_by_role("button", name="Stop", exact=True).click()
        page.get_by_text("Stopped.", exact=True).first.wait_for(timeout=PATIENT)
        assert page.get_by_role("button", name="Generate", exact=True).is_visible()
        assert epg.state()["simulation"]["result"] is None
