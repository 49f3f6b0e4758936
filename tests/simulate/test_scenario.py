# SPDX-License-Identifier: Apache-2.0
"""Scenario files: their meaning, and the messages for wrong ones (golden files beside the wrong scenarios)."""

from __future__ import annotations

import math
import os
from fractions import Fraction
from pathlib import Path

import pytest

from epg.cli.report import format_diagnostics
from epg.generator.diagnostics import Diagnostics
from epg.runs.interface import check_names, interface_of
from epg.runs.scenario import Scenario
from epg.runs.setpoint_file import setpoint_rows, write_setpoints
from epg.simulate.load_scenario import load_scenario

HERE = Path(__file__).resolve().parent
EXAMPLES = HERE.parents[1] / "examples"

HEAD = "version: 1\nduration: 1 s\ninterval: 100 ms\n"
AXES = "axes: {pan: {setpoint: pan, position: outputs.pan}}\n"


def load(folder: Path, text: str) -> Scenario:
    path = folder / "scenario.yaml"
    path.write_text(text, encoding="utf-8")
    diagnostics = Diagnostics()
    scenario = load_scenario(path, diagnostics)
    assert scenario is not None, format_diagnostics(diagnostics)
    return scenario


@pytest.mark.parametrize("name", sorted(path.stem for path in (HERE / "wrong").glob("*.yaml")))
def test_wrong_scenario(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """A file ``.interface`` has the names of the program.  ``EPG_UPDATE_GOLDEN=1`` rewrites the expected texts."""
    monkeypatch.chdir(HERE / "wrong")
    diagnostics = Diagnostics()
    scenario, interface = load_scenario(Path(f"{name}.yaml"), diagnostics), Path(f"{name}.interface")
    if interface.is_file():
        assert scenario is not None, format_diagnostics(diagnostics)
        check_names(scenario, interface_of(interface.read_text(encoding="utf-8")), diagnostics)
    assert diagnostics.has_errors and (interface.is_file() or scenario is None)
    text = format_diagnostics(diagnostics)
    golden = HERE / "wrong" / f"{name}.txt"
    if os.environ.get("EPG_UPDATE_GOLDEN"):
        golden.write_text(text, encoding="utf-8", newline="\n")
    assert text == golden.read_text(encoding="utf-8")


@pytest.mark.parametrize("path", sorted(EXAMPLES.glob("*/*.yaml")), ids=lambda path: f"{path.parent.name}-{path.stem}")
def test_examples_are_valid(path: Path) -> None:
    if path.name.endswith((".bindings.yaml", ".system.yaml")):
        return
    diagnostics = Diagnostics()
    assert load_scenario(path, diagnostics) is not None, format_diagnostics(diagnostics)


def test_shapes(tmp_path: Path) -> None:
    parts = """setpoints:
  pan:
    initial: 1
    profile:
      - {shape: raised_cosine, start: 1 s, duration: 2 s, height: 180 deg}
      - {shape: move, start: 4 s, duration: 2 s, to: 3}
      - {shape: ramp, start: 6 s, duration: 4 s, to: -1}
      - {shape: step, start: 11 s, to: 5}
      - {shape: sine, start: 12 s, duration: 2 s, height: 2, frequency: 0.5 Hz}
"""
    profile = load(tmp_path, "version: 1\nduration: 20 s\n" + parts + AXES).profiles["pan"]
    expected = {
        0: 1,
        1: 1,
        2: 1 + math.pi,
        3: 1,
        4: 1,
        5: 2,
        6: 3,
        8: 1,
        10: -1,
        10.9: -1,
        11: 5,
        12.5: 7,
        13.5: 3,
        19: 5,
    }
    for time, value in expected.items():
        assert profile.value(time) == pytest.approx(value), time
    assert profile.span == (1.0, 14.0)


def test_setpoints_come_at_their_interval(tmp_path: Path) -> None:
    scenario = load(tmp_path, HEAD + "setpoints: {pan: {initial: 2}, tilt: {}}\n" + AXES)
    rows = setpoint_rows(scenario)
    assert [time for time, topic, _ in rows if topic == "pan"] == [Fraction(n, 10) for n in range(10)]
    assert {(topic, value) for _, topic, value in rows} == {("pan", 2.0), ("tilt", 0.0)}
    write_setpoints(rows, tmp_path / "out.csv")
    lines = (tmp_path / "out.csv").read_text(encoding="utf-8").splitlines()
    assert lines[:4] == ["time,topic,value", "0.0,pan,2.0", "0.0,tilt,0.0", "0.1,pan,2.0"]


def test_events_become_rows(tmp_path: Path) -> None:
    events = """events:
  - {at: 0.9 s, enable: true}
  - {at: 0.15 s, enable: false}
  - {at: 0.2 s, setpoint: .nan, topic: pan}
  - {at: 0.25 s, setpoint: 90 deg, topic: pan}
  - {at: 0.4 s, stall: 5 ms}
  - {at: 0.5 s, component: button, level: true}
  - {at: 0.7 s, component: button, level: open}
  - {at: 0.55 s, lost: 250 ms, topic: pan}
"""
    scenario = load(tmp_path, HEAD + "setpoints: {pan: {}, tilt: {}}\n" + events + AXES)
    rows = setpoint_rows(scenario)
    special = [(float(time), topic, value) for time, topic, value in rows if topic.startswith("$")]
    assert special == [
        (0.15, "$enable", 0.0),
        (0.4, "$stall", 0.005),
        (0.5, "$component:button", "1"),
        (0.7, "$component:button", "open"),
        (0.9, "$enable", 1.0),
    ]
    assert [float(time) for time, topic, _ in rows if topic == "pan"] == [
        0,
        0.1,
        0.2,
        0.2,
        0.25,
        0.3,
        0.4,
        0.5,
        0.8,
        0.9,
    ]
    assert len([row for row in rows if row[1] == "tilt"]) == 10, "lost on one topic only"
    assert any(isinstance(value, float) and math.isnan(value) for _, _, value in rows)
    assert (Fraction(1, 4), "pan", math.pi / 2) in rows
    assert [row[0] for row in rows] == sorted(row[0] for row in rows)
    assert not [row for row in setpoint_rows(scenario, realtime=True) if row[1] == "$stall"]


@pytest.mark.parametrize("name", ["a" * 5000 + ".py", "a/" * 3000 + "x.py", "a\\0b.py"], ids=["long", "deep", "nul"])
def test_a_reference_that_no_system_can_have(name: str, tmp_path: Path) -> None:
    path = tmp_path / "scenario.yaml"
    text = (HERE / "wrong/axes.yaml").read_text()
    assert "reference: ideal_lop.py" in text
    path.write_text(text.replace("ideal_lop.py", f'"{name}"'))
    diagnostics = Diagnostics()
    assert load_scenario(path, diagnostics) is None
    (message,) = [problem.message for problem in diagnostics if problem.id == "file-not-found"]
    assert message.startswith("there is no file '")
