# SPDX-License-Identifier: Apache-2.0
"""The page shows the same facts about the same files as the command line."""

from __future__ import annotations

import json
import re
import shutil
from pathlib import Path
from typing import Any

import pytest

from epg.cli.main import main
from epg.connect.loaded import Loaded, Models
from epg.connect.loaded import load as load_with
from epg.connect.pictures import draw
from epg.connect.unused_parts import unused_parts
from epg.connect.view import view_of
from epg.generator.catalog.catalog import load_catalog
from epg.generator.diagnostics import Diagnostics
from epg.generator.project import Request, load_configuration

ROOT = Path(__file__).resolve().parent.parent.parent
TCF = """version: 1
extends: rpi_pico_bare_metal_jiwy.tcf
components:
  encoder_pan: {unit: deg}
  pwm_pan: {scale: 1/2, limits: [-0.4, 0.4]}
"""


@pytest.fixture
def files(tmp_path: Path) -> Path:
    shutil.copytree(ROOT / "examples/jiwy/model", tmp_path / "model")
    shutil.copy(ROOT / "examples/jiwy/jiwy.bindings.yaml", tmp_path / "b.yaml")
    (tmp_path / "t.tcf").write_text(TCF)
    return tmp_path


def load(request: Request) -> Loaded:
    return load_with(request, Models())


def request(folder: Path, **others: Any) -> Request:
    return Request("target", str(folder / "t.tcf"), folder / "model", folder / "b.yaml", **others)


def view(folder: Path) -> dict[str, Any]:
    return view_of(load(request(folder)))


def edit(path: Path, *changes: tuple[str, str]) -> None:
    text = path.read_text()
    for before, after in changes:
        assert text.count(before) == 1, before
        text = text.replace(before, after)
    path.write_text(text)


MISTAKES: dict[str, tuple[list[tuple[str, str]], list[tuple[str, str]], set[tuple[str, str | None, str | None]]]] = {
    "nothing": ([], [], set()),
    "unbound": (
        [("  position_pan: encoder_pan\n", ""), ("  pwm_tilt: pwm_tilt\n", "")],
        [],
        {("unbound-input", "position_pan", None), ("unbound-output", "pwm_tilt", None)},
    ),
    "unknown component": (
        [("position_pan: encoder_pan", "position_pan: {from: encoder_pam, scale: 2}")],
        [],
        {("unknown-component", "position_pan", None)},
    ),
    "twice and wrong": (
        [
            ("pwm_tilt: pwm_tilt", "pwm_tilt: [pwm_tilt, pwm_pan]"),
            ("setpoint_pan: pan_subscriber", "setpoint_pan: pwm_pan"),
        ],
        [],
        {("bound-twice", "pwm_tilt", None), ("wrong-direction", "setpoint_pan", None)},
    ),
    "a value": (
        [("position_pan: encoder_pan", "position_pan: {from: encoder_pan, scale: 0, limits: [2, 1]}")],
        [],
        {("wrong-value", "position_pan", None)},
    ),
    "a port that is not there": (
        [("pwm_tilt: pwm_tilt", "pwm_tilt: pwm_tilt\n  pwm_roll: {to: pwm_tilt}")],
        [],
        {("unknown-port", "pwm_roll", None)},
    ),
    "no such key": (
        [("pwm_tilt: pwm_tilt", "pwm_tilt:\n    to: pwm_tilt\n    scal: 2")],
        [],
        {("unknown-key", "pwm_tilt", None)},
    ),
    "units": (
        [("position_pan: encoder_pan", "position_pan: {from: encoder_pan, unit: kg}")],
        [],
        {("unit-mismatch", "position_pan", None)},
    ),
    "a pin twice": (
        [],
        [("{unit: deg}", "{unit: deg, pins: {a: 12, b: 13}}")],
        {("pin-used-twice", None, "encoder_tilt")},
    ),
    "a component": ([], [("{unit: deg}", "{unit: deg, nothing: 3}")], {("unknown-key", None, "encoder_pan")}),
    "no yaml": ([("inputs:", "inputs: {")], [], {("yaml-syntax", None, None)}),
    "no target": ([], [("extends: rpi_pico_bare_metal_jiwy.tcf", "extends: jwy.tcf")], {("tcf-not-found", None, None)}),
    "another model": ([("model: JIWY_Control", "model: JIWY")], [], {("wrong-model", None, None)}),
}


@pytest.mark.parametrize("name", MISTAKES)
def test_messages_are_those_of_the_command_line(name: str, files: Path, capsys: pytest.CaptureFixture[str]) -> None:
    in_bindings, in_tcf, about = MISTAKES[name]
    edit(files / "b.yaml", *in_bindings)
    edit(files / "t.tcf", *in_tcf)
    shown = view(files)["diagnostics"]
    arguments = ["--tcf", str(files / "t.tcf"), "--model", str(files / "model"), "--bindings", str(files / "b.yaml")]
    main(["check", "--json", *arguments])
    said = json.loads(capsys.readouterr().out)["diagnostics"]
    added = ("port", "ports", "component", "path")
    shown_here = [{key: value for key, value in each.items() if key not in added} for each in shown]
    assert shown_here == [{key: value for key, value in each.items() if key != "edits"} for each in said]
    found = {(each["id"], each["port"], each["component"]) for each in shown}
    assert about <= found if about else not found


def test_a_draft_says_what_the_saved_file_would(files: Path, capsys: pytest.CaptureFixture[str]) -> None:
    text = (files / "b.yaml").read_text().replace("pwm_pan: pwm_pan", "pwm_pan: encoder_pan")
    tcf = TCF.replace("unit: deg", "unit: kg")
    drafted = view_of(load(request(files, drafts={files / "b.yaml": text, files / "t.tcf": tcf})))
    assert drafted["diagnostics"]
    assert view(files)["diagnostics"] == []
    (files / "b.yaml").write_text(text)
    (files / "t.tcf").write_text(tcf)
    assert view(files) == drafted


def test_conversions_say_where_they_come_from(files: Path) -> None:
    edit(
        files / "b.yaml",
        ("position_tilt: encoder_tilt", "position_tilt: {from: encoder_tilt, scale: 1/3, offset: -0.1}"),
        ("pwm_pan: pwm_pan", "pwm_pan: {to: pwm_pan, scale: 0.5, limits: [-1, 1]}"),
    )
    wires = view(files)["wires"]
    told = {name: (end["text"], end["from_tcf"]) for name, (end,) in wires.items()}
    assert told["position_pan"] == ("deg → rad", "rad → deg ×57.2958")
    assert told["position_tilt"] == ("×1/3 -0.1", "")
    assert told["pwm_pan"] == ("×0.5 in -1…1", "×0.5 in -0.4…0.4")
    assert told["setpoint_pan"] == ("", "in -0.05…3.2")


def test_units_that_convert_are_those_of_the_application(files: Path) -> None:
    """The page shows a conversion of units exactly where the generated code has one."""
    edit(
        files / "b.yaml",
        ("position_tilt: encoder_tilt", "position_tilt: {from: encoder_tilt, unit: deg}"),
        ("setpoint_pan: pan_subscriber", "setpoint_pan: {from: pan_subscriber, unit: deg, scale: 1}"),
        ("pan_logging: pan_publisher", "pan_logging: {to: pan_publisher, unit: deg}"),
    )
    loaded = load(request(files))
    application = loaded.parts.application
    assert application is not None
    for wire in (*application.inputs, *application.outputs):
        (end,) = view_of(loaded)["wires"][wire.port.name]
        shown = re.findall(r"(\w+ → \w+)", f"{end['text']} {end['from_tcf']}")
        steps = [step.reason.replace("->", "→") for step in wire.steps if " -> " in step.reason]
        assert sorted(shown) == sorted(steps), wire.port.name


def test_components_and_hardware(files: Path, capsys: pytest.CaptureFixture[str]) -> None:
    shown = view(files)
    components = {each["name"]: each for each in shown["components"]}
    pan = components["encoder_pan"]
    assert pan["kind"] == "quadrature_encoder" and pan["where"] == ["a GP10", "b GP11"]
    assert pan["peripheral"] == "PIO block 0, state machine 0"
    assert [(port["reference"], port["direction"], port["unit"]) for port in pan["ports"]] == [
        ("encoder_pan", "source", "deg"),
        ("encoder_pan.reset", "sink", ""),
    ]
    assert components["pan_subscriber"]["topic"] == "/pan_subscriber"
    arguments = ["--tcf", str(files / "t.tcf"), "--model", str(files / "model"), "--bindings", str(files / "b.yaml")]
    main(["check", "--json", "--hardware", *arguments])
    said = json.loads(capsys.readouterr().out)["hardware"][str(files / "t.tcf")]
    assert [row["resource"] for row in shown["hardware"]] == [row["resource"] for row in said]
    rows = {(row["component"], row["claim"]): row for row in shown["hardware"]}
    assert rows["encoder_pan", "encoder"]["pins"] == "a GP10, b GP11"
    assert any(row["component"] == "(control loop)" for row in shown["hardware"])


def test_pictures_are_drawn_as_far_as_files_are_right(files: Path) -> None:
    loaded = load(request(files))
    for name in ("wiring", "application", "schedule"):
        svg = draw(loaded, name, "jiwy")
        assert svg is not None and svg.startswith("<svg") and "jiwy" in svg
    assert draw(loaded, "other", "jiwy") is None
    edit(files / "b.yaml", ("pwm_pan: pwm_pan", "pwm_pan: encoder_pan"))
    loaded = load(request(files))
    assert view_of(loaded)["pictures"] == {"wiring": True, "application": False, "schedule": False}
    assert draw(loaded, "application", "jiwy") is None
    assert "GP10" in (draw(loaded, "wiring", "jiwy") or "")


def test_proposals_give_no_output_away_twice(files: Path) -> None:
    edit(files / "b.yaml", ("  pwm_tilt: pwm_tilt\n", ""), ("pwm_pan: pwm_pan", "pwm_pan: pwm_tilt"))
    shown = view(files)
    assert "pwm_tilt" not in shown["proposals"] and "pwm_tilt" not in shown["wires"]
    edit(files / "b.yaml", ("pwm_pan: pwm_tilt", "pwm_pan: pwm_pan"))
    assert view(files)["proposals"] == {"pwm_tilt": "pwm_tilt"}


def test_an_input_that_can_stop_the_robot_is_never_left_out() -> None:
    folder = ROOT / "tests" / "errors" / "common"
    asked = Request("robot", "robot.tcf", folder / "model", folder / "bindings.yaml", beside=folder)
    configuration = load_configuration(asked, load_catalog(asked.roots, Diagnostics()), Diagnostics())
    assert configuration is not None
    assert {name for (name,) in unused_parts(configuration, ())} == {"encoder", "motor", "target", "position"}
