# SPDX-License-Identifier: Apache-2.0
"""The picture of a finished simulation: its lines, their gaps, and the numbers of its axes."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from epg.generator.diagnostics import Diagnostics
from epg.graph.tracking_picture import draw_tracking as draw
from epg.graph.tracking_picture import ticks
from epg.simulate.load_scenario import load_scenario

SCENARIO = """version: 1
duration: 2 s
setpoints: {pan: {profile: [{shape: step, start: 1 s, to: 1}]}}
axes:
  pan: {setpoint: pan, position: plant.outputs.angle, unit: rad, homing: {until: 0.5 s}}
"""


def picture(folder: Path, rows: list[tuple[str, ...]]) -> str:
    (folder / "scenario.yaml").write_text(SCENARIO)
    diagnostics = Diagnostics()
    scenario = load_scenario(folder / "scenario.yaml", diagnostics)
    assert scenario is not None and not diagnostics.has_errors, list(diagnostics)
    (folder / "tracking.csv").write_text("".join(f"{','.join(row)}\n" for row in rows))
    return draw(folder / "tracking.csv", scenario)


def lines(svg: str, style: str) -> list[list[tuple[float, float]]]:
    found = re.findall(rf'<polyline points="([^"]*)" class="{style}"', svg)
    return [[tuple(map(float, point.split(","))) for point in text.split()] for text in found]  # type: ignore[misc]


def test_the_lines_have_the_extremes_of_each_pixel_and_break_at_gaps(tmp_path: Path) -> None:
    head = ("time", "pan_setpoint", "pan_position")
    rows = [head]
    for step in range(2000):
        time = step / 1000
        position = "" if 400 <= step < 450 else "5" if step == 1500 else repr(time / 2)
        rows.append((repr(time), "0" if time < 1 else "1", position))
    svg = picture(tmp_path, rows)
    legend, first, second, error = lines(svg, "w0")
    assert len(legend) == 2
    assert first[-1][0] == pytest.approx(84 + 720 * 0.399 / 2, abs=0.1), "the line ends where the values do"
    assert second[0][0] == pytest.approx(84 + 720 * 0.450 / 2, abs=0.1)
    assert len(second) < 3 * 720 and min(y for _, y in second) < min(y for _, y in first) - 100, "the peak is there"
    assert error[0][0] == pytest.approx(84 + 720 * 0.5 / 2, abs=0.1), "no error is shown before the end of homing"
    assert ">homing</text>" in svg and ">pan in rad</text>" in svg and ">reference</text>" not in svg


def test_a_reference_is_a_line_of_its_own_colour(tmp_path: Path) -> None:
    rows = [("time", "pan_setpoint", "pan_reference", "pan_position")]
    rows += [(repr(step / 10), "0", "0.5", "0.25") for step in range(20)]
    svg = picture(tmp_path, rows)
    assert len(lines(svg, "w1")) == 2 and ">reference</text>" in svg


def test_values_that_do_not_change_and_none_at_all(tmp_path: Path) -> None:
    head = ("time", "pan_setpoint", "pan_position")
    assert len(lines(picture(tmp_path, [head, ("0", "0", "0"), ("1", "0", "0")]), "w0")) == 2
    assert len(lines(picture(tmp_path, [head]), "w0")) == 1, "only the legend"


def test_ticks_are_round_numbers() -> None:
    assert ticks(-0.02, 0.31, 4) == [0.0, 0.1, 0.2, 0.3]
    assert ticks(0, 18, 9) == [0, 2, 4, 6, 8, 10, 12, 14, 16, 18]
    assert ticks(-3e-7, 2.5e-7, 2) == [0.0]
