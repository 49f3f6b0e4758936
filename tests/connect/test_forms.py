# SPDX-License-Identifier: Apache-2.0
"""Forms have the parameters that ``epg check`` knows, and the values, files and lines of the ``.tcf``."""

from __future__ import annotations

import shutil
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import pytest

from epg.connect.forms import forms_of, value_of
from epg.connect.loaded import Loaded, Models, load
from epg.connect.view import view_of
from epg.generator.catalog.catalog import load_catalog
from epg.generator.data import targets_roots
from epg.generator.diagnostics import Diagnostics
from epg.generator.project import Request
from epg.generator.source import Span

ROOT = Path(__file__).resolve().parents[2]
CATALOG = load_catalog(targets_roots(()), Diagnostics())
TCF = """version: 1
extends: robot.tcf
node: axis
communication: {middleware: xrce}
components:
  motor: {frequency: 25 kHz}
  lamp: null
"""
ROBOT = """version: 1
target: rpi_pico2_bare_metal
components:
  motor: {kind: pwm_h_bridge, frequency: 20 kHz, max_duty: 0.8, pins: {value: 2, direction_a: 3, direction_b: 4}}
  encoder:
    kind: quadrature_encoder
    pins: {a: GP10, b: GP11}
    span: {counts: 1112, angle: 180 deg}
  lamp: {kind: digital_output, pins: {value: 6}}
  stop: {kind: digital_input, pins: {value: 7}, pull: up, invert: true}
  guard: {kind: motion_guard, actuator: motor, encoder: encoder, stall: {}}
"""


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    shutil.copytree(ROOT / "examples/jiwy/model", tmp_path / "model")
    (tmp_path / "axis.tcf").write_text(TCF)
    (tmp_path / "robot.tcf").write_text(ROBOT)
    (tmp_path / "b.yaml").write_text("version: 1\nmodel: JIWY_Control\n")
    return tmp_path


def loaded(folder: Path, tcf: str = "axis.tcf", **others: Any) -> Loaded:
    return load(Request("axis", str(folder / tcf), folder / "model", folder / "b.yaml", **others), Models())


def forms(folder: Path, **others: Any) -> dict[str, Any]:
    return forms_of(loaded(folder, **others), CATALOG, owns_tcf=True).data()


def fields(form: Mapping[str, Any]) -> dict[str, dict[str, Any]]:
    return {field["name"]: field for field in form["fields"]}


def settings(found: dict[str, Any]) -> dict[str, dict[str, Any]]:
    return {".".join(field["path"]): field for section in found["settings"] for field in section["fields"]}


def test_every_parameter_of_every_kind_has_a_field(folder: Path) -> None:
    kinds = forms(folder)["kinds"]
    assert sorted(kinds) == CATALOG.kind_names()
    for name, form in kinds.items():
        kind = CATALOG.find_kind(name)
        assert kind is not None and form["summary"] == kind.summary and form["group"]
        wanted = {parameter.name for parameter in kind.parameters} | {use.name for use in kind.uses}
        assert wanted <= set(fields(form)), name
        for field in form["fields"]:
            assert field["description"] and (field["type"] != "choice" or field["choices"]), (name, field)


def test_a_field_says_what_is_possible(folder: Path) -> None:
    kinds = forms(folder)["kinds"]
    bridge = fields(kinds["pwm_h_bridge"])
    assert bridge["frequency"] == {
        "path": ["frequency"],
        "name": "frequency",
        "type": "quantity",
        "description": "frequency of the PWM (more than 0 Hz)",
        "default": "20 kHz",
        "units": ["Hz", "kHz", "MHz"],
    }
    assert (bridge["safe"]["type"], bridge["safe"]["choices"]) == ("choice", ["coast", "brake"])
    assert (bridge["invert"]["type"], bridge["invert"]["default"]) == ("boolean", "false")
    assert [(pin["path"], pin["type"]) for pin in bridge["pins"]["fields"]] == [
        (["pins", name], "pin") for name in ("value", "direction_a", "direction_b")
    ]
    encoder = kinds["quadrature_encoder"]
    assert encoder["one_of"] == [{"names": ["counts_per_revolution", "span"], "several": False}]
    assert [(part["name"], part["required"]) for part in fields(encoder)["span"]["fields"]] == [
        ("counts", True),
        ("angle", True),
    ]
    guard = fields(kinds["motion_guard"])
    assert (guard["actuator"]["type"], guard["actuator"]["choices"]) == ("reference", ["motor"])
    assert guard["encoder"]["choices"] == ["encoder"]
    assert list(guard)[:2] == ["actuator", "encoder"]
    assert kinds["motion_guard"]["one_of"] == [{"names": ["stall", "runaway", "homing"], "several": True}]
    assert fields(kinds["ros_subscriber"])["topic"]["required"]


def test_a_value_has_its_file_and_the_way_back(folder: Path) -> None:
    values = forms(folder)["values"]
    assert values["components.motor.frequency"] == {
        "text": "25 kHz",
        "how": "own",
        "file": str(folder / "axis.tcf"),
        "line": 6,
        "own": True,
        "back": {"text": "20 kHz", "how": "file", "file": str(folder / "robot.tcf"), "line": 4},
    }
    assert values["components.motor.max_duty"] == {
        "text": "0.8",
        "how": "file",
        "file": str(folder / "robot.tcf"),
        "line": 4,
    }
    assert values["components.encoder.span.angle"]["text"] == "180 deg"
    assert values["components.guard.stall"]["text"] == "{}"
    assert "components.motor.invert" not in values  # its default holds
    assert values["communication.middleware"]["own"] and "back" not in values["communication.middleware"]
    assert "components.lamp" not in values and forms(folder)["left_out"] == ["lamp"]


def test_files_of_epg_and_arguments_in_cmake_are_told_apart(folder: Path) -> None:
    (folder / "axis.tcf").write_text("version: 1\nextends: rpi_pico_bare_metal_jiwy.tcf\ncontrol: {period: 1 ms}\n")
    found = loaded(folder)
    values = forms_of(found, CATALOG, owns_tcf=True).data()["values"]
    assert values["components.pwm_pan.frequency"]["how"] == "epg"
    assert values["control.period"]["how"] == "own"
    assert forms_of(found, CATALOG, owns_tcf=False).values["control.period"].how == "file"

    argument = ("control.period=2 ms", Span("CMakeLists.txt", 7, 3, 20))
    changed = forms(folder, settings=[argument])["values"]["control.period"]
    assert (changed["text"], changed["how"], changed["line"]) == ("2 ms", "call", 7)


def test_settings_are_those_that_have_an_effect(folder: Path) -> None:
    found = settings(forms(folder))
    assert found["control.fail_safe"]["choices"] == ["stop"]
    assert "xrce" in found["communication.middleware"]["choices"]
    assert found["communication.transport"]["choices"][0] == found["communication.transport"]["default"] == "usb"
    assert {"communication.mtu", "communication.domain", "node", "namespace", "clocks.sys"} <= set(found)
    assert "communication.jog_duty" not in found
    (folder / "axis.tcf").write_text(TCF.replace("xrce", "console"))
    found = settings(forms(folder))
    assert "communication.jog_duty" in found and "communication.domain" not in found
    assert "communication.console" not in found


def test_components_stay_in_sight_while_one_has_an_error(folder: Path) -> None:
    (folder / "robot.tcf").write_text(
        ROBOT.replace("pull: up", "pull: upwards").replace("kind: digital_out", "kind: x")
    )
    found = loaded(folder)
    assert found.parts.configuration is None
    shown = {each["name"]: [port["reference"] for port in each["ports"]] for each in view_of(found)["components"]}
    assert shown == {"motor": ["motor"], "encoder": ["encoder", "encoder.reset"], "stop": ["stop"], "guard": []}
    assert forms(folder)["values"]["components.stop.pull"]["text"] == "upwards"


@pytest.mark.parametrize(
    ("before", "after", "path"),
    [
        ("pull: up,", "pull: upwards,", "components.stop.pull"),
        ("actuator: motor, ", "", "components.guard.actuator"),
        (", pins: {value: 7}", "", "components.stop.pins"),
        ("angle: 180 deg", "angle: 180", "components.encoder.span.angle"),
        ("counts: 1112, ", "", "components.encoder.span.counts"),
        ("direction_b: 4", "direction_b: 3", "components.motor.pins.direction_b"),
        ("GP11", "GP12", "components.encoder.pins.b"),
    ],
)
def test_a_message_is_at_its_field(folder: Path, before: str, after: str, path: str) -> None:
    assert before in ROBOT
    (folder / "robot.tcf").write_text(ROBOT.replace(before, after))
    errors = [each for each in view_of(loaded(folder))["diagnostics"] if each["path"]]
    assert path in [".".join(each["path"]) for each in errors if each["severity"] == "error"], errors


def test_a_message_of_the_settings_is_at_its_field(folder: Path) -> None:
    (folder / "axis.tcf").write_text(TCF.replace("node: axis\n", "").replace("xrce", "xrec"))
    errors = {each["id"]: ".".join(each["path"]) for each in view_of(loaded(folder))["diagnostics"]}
    assert errors["missing-key"] == "node"
    (folder / "axis.tcf").write_text(TCF.replace("xrce", "xrec"))
    errors = {each["id"]: ".".join(each["path"]) for each in view_of(loaded(folder))["diagnostics"]}
    assert errors["unknown-middleware"] == "communication.middleware"


def test_texts_become_values(folder: Path) -> None:
    found = forms_of(loaded(folder), CATALOG, owns_tcf=True)

    def value(path: str, text: str) -> object:
        field = found.field_at(path.split("."))
        assert field is not None
        return value_of(field, text, ValueError)

    assert value("control.period", "2 ms") == "2 ms"
    assert value("control.enable_at_start", "true") is True
    assert value("control.overrun_limit", "12") == 12
    assert value("control.overrun_limit", "a dozen") == "a dozen"
    assert value("components.motor.max_duty", "0.5") == 0.5
    assert value("components.motor.max_duty", "nan") == "nan"
    assert value("components.encoder.gear", "5625/361") == "5625/361"
    assert value("components.encoder.pins.a", "12") == 12
    assert value("components.encoder.pins.a", "GP12") == "GP12"
    assert value("components.encoder.limits", "[-1, 1]") == [-1, 1]
    assert value("control.enable_topic", "false") is False
    assert value("control.enable_topic", "~/on") == "~/on"
    assert value("node", "12") == "12"
    assert found.field_at(["components", "motor", "frequenzy"]) is None
    assert found.field_at(["components", "lamp", "invert"]) is None
    with pytest.raises(ValueError, match="bracket"):
        value("components.encoder.limits", "[-1, 1")
