# SPDX-License-Identifier: Apache-2.0
"""Components and values of a project's own .tcf are changed as the page does it; inherited files stay as they are."""

from __future__ import annotations

import shutil
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from epg.connect.body import Refused
from epg.connect.session import Session
from tests.connect.page import session_of
from tests.connect.robots import own_axis_project, with_second_target

ENCODER = {"kind": "quadrature_encoder", "name": "encoder", "values": {"counts_per_revolution": "4096"}}


@pytest.fixture(scope="module")
def axis_session(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Session]:
    session = session_of(own_axis_project(tmp_path_factory.mktemp("axis")))
    yield session
    session.ended.set()


@pytest.fixture
def axis(axis_session: Session) -> Iterator[Session]:
    """A project whose .tcf has all of its components itself.  Tests do not save it."""
    yield axis_session
    axis_session.act("reload", {})


@pytest.fixture(scope="module")
def jiwy_session(new_project: Path) -> Iterator[Session]:
    session = session_of(new_project)
    yield session
    session.ended.set()


@pytest.fixture
def jiwy(jiwy_session: Session) -> Iterator[Session]:
    """A project whose .tcf extends one of EPG's.  Tests do not save it."""
    yield jiwy_session
    jiwy_session.act("reload", {})


def diff(state: dict[str, Any]) -> list[str]:
    lines: list[str] = state["draft"]["diff"].splitlines()
    return [line for line in lines if line[:1] in "+-" and line[:3] not in ("+++", "---")]


def problems(state: dict[str, Any]) -> list[str]:
    return [each["message"] for each in state["diagnostics"] if each["severity"] == "error"]


def fill(session: Session, path: str, text: str) -> dict[str, Any]:
    return session.act("fill", {"changes": [{"path": path.split("."), "text": text}]})


def test_an_added_component_has_free_pins(axis: Session) -> None:
    state = axis.act("add", ENCODER)
    assert problems(state) == []
    assert diff(state) == [
        "+  encoder: {kind: quadrature_encoder, counts_per_revolution: 4096, pins: {a: GP2, b: GP3}}"
    ]
    values = {"pins.value": "GP3"}
    state = axis.act("add", {"kind": "pwm_h_bridge", "name": "motor", "values": values})
    assert state["forms"]["values"]["components.motor.pins.value"]["text"] == "GP3"
    assert [each for each in state["diagnostics"] if each["path"] == ["components", "motor", "pins", "value"]]


@pytest.mark.parametrize(
    ("body", "message"),
    [
        ({**ENCODER, "name": "position_x"}, "there is a component 'position_x' already"),
        ({**ENCODER, "name": "a b"}, "is not a C identifier"),
        ({**ENCODER, "kind": "laser"}, "there is no kind 'laser'"),
        ({**ENCODER, "values": {"colour": "red"}}, "has no parameter 'colour'"),
        ({**ENCODER, "values": {"limits": "[1"}}, "bracket"),
    ],
)
def test_a_wrong_component_is_refused(axis: Session, body: dict[str, Any], message: str) -> None:
    with pytest.raises(Refused, match=message):
        axis.act("add", body)
    assert not axis.state()["draft"]["changed"]


def test_a_name_follows_everywhere(tmp_path: Path) -> None:
    axis = session_of(own_axis_project(tmp_path))
    axis.act("add", ENCODER)
    axis.act("add", {"kind": "pwm_h_bridge", "name": "motor", "values": {}})
    guard = {"actuator": "motor", "encoder": "encoder", "stall": "{}", "runaway.duty": "0.2"}
    axis.act("add", {"kind": "motion_guard", "name": "guard", "values": guard})
    axis.act("add", {"kind": "digital_input", "name": "stop", "values": {"pull": "up", "invert": "true"}})
    fill(axis, "control.fail_safe", "stop")
    axis.act("connect", {"port": "position_x", "ends": [{"reference": "encoder"}]})
    axis.act("connect", {"port": "duty_x", "ends": [{"reference": "motor"}, {"reference": "encoder.reset"}]})
    state = axis.act("save", {})
    assert problems(state) == []
    assert state["users"]["encoder"] == {
        "ports": ["position_x", "duty_x"],
        "components": ["guard"],
        "settings": [],
        "files": [],
    }

    axis.act("rename", {"component": "encoder", "name": "encoder_x"})
    state = axis.act("rename", {"component": "stop", "name": "emergency_stop"})
    assert problems(state) == []
    assert state["forms"]["values"]["control.fail_safe"]["text"] == "emergency_stop"
    assert state["forms"]["values"]["components.guard.encoder"]["text"] == "encoder_x"
    assert [end["reference"] for end in state["wires"]["duty_x"]] == ["motor", "encoder_x.reset"]
    old = [line[1:] for line in diff(state) if line[0] == "-"]
    new = [line[1:] for line in diff(state) if line[0] == "+"]
    swapped = [line.replace("encoder_x", "encoder").replace("emergency_stop", "stop") for line in new]
    assert old == swapped and len(old) == 6

    state = axis.act("remove", {"component": "encoder_x"})
    names = [each["name"] for each in state["components"]]
    assert "encoder_x" not in names and "guard" not in names and "motor" in names  # a guard needs its encoder
    assert "position_x" not in state["wires"]
    assert [end["reference"] for end in state["wires"]["duty_x"]] == ["motor"]
    state = axis.act("remove", {"component": "emergency_stop"})
    assert "control.fail_safe" not in state["forms"]["values"]
    state = axis.act("undo", {})
    state = axis.act("undo", {})
    assert problems(state) == [] and len(diff(state)) == 12


def test_a_copy_has_other_pins_and_another_topic(axis: Session) -> None:
    axis.act("add", ENCODER)
    axis.act("copy", {"component": "encoder", "name": "encoder_y"})
    state = axis.act("copy", {"component": "setpoint_x", "name": "setpoint_y"})
    assert problems(state) == []
    assert diff(state)[1:] == [
        "+  encoder_y: {kind: quadrature_encoder, counts_per_revolution: 4096, pins: {a: GP4, b: GP5}}",
        "+  setpoint_y: {kind: ros_subscriber, topic: setpoint_y}",
    ]


def test_a_group_of_values_is_switched_on_and_off(axis: Session) -> None:
    axis.act("add", ENCODER)
    state = fill(axis, "components.encoder.span", "{}")
    assert any(each["path"] == ["components", "encoder", "span", "counts"] for each in state["diagnostics"])
    fill(axis, "components.encoder.span.counts", "1112")
    fill(axis, "components.encoder.span.angle", "180 deg")
    state = fill(axis, "components.encoder.counts_per_revolution", "")
    assert problems(state) == []
    assert "span: {counts: 1112, angle: 180 deg}" in diff(state)[0]
    axis.act("take_back", {"path": ["components", "encoder", "span", "counts"]})
    state = axis.act("take_back", {"path": ["components", "encoder", "span", "angle"]})
    assert "span: {}" in diff(state)[0]  # the group itself stays
    state = fill(axis, "components.encoder.span", "")
    assert "span" not in diff(state)[0]


def test_an_inherited_value_is_overridden_and_comes_back(jiwy: Session, new_project: Path) -> None:
    before = jiwy.state()["forms"]["values"]["components.pwm_pan.frequency"]
    assert before["how"] == "epg" and "own" not in before
    state = fill(jiwy, "components.pwm_pan.frequency", "10 kHz")
    assert diff(state) == ["+components:", "+  pwm_pan: {frequency: 10 kHz}"]
    value = state["forms"]["values"]["components.pwm_pan.frequency"]
    assert value["own"] and value["how"] == "own" and value["file"] == str(new_project / "robot.tcf")
    assert value["back"]["text"] == before["text"] and value["back"]["file"] == before["file"]
    state = fill(jiwy, "components.pwm_pan.frequency", "")  # the default of the kind, without EPG's value
    assert diff(state) == ["+components:", "+  pwm_pan: {frequency: null}"]
    assert state["forms"]["values"]["components.pwm_pan.frequency"]["removed"]
    state = jiwy.act("take_back", {"path": ["components", "pwm_pan", "frequency"]})
    assert diff(state) == [] and state["forms"]["values"]["components.pwm_pan.frequency"] == before


def test_an_inherited_component_is_left_out_and_brought_back(jiwy: Session) -> None:
    state = jiwy.act("remove", {"component": "encoder_tilt"})
    assert set(state["forms"]["left_out"]) == {"encoder_tilt", "guard_tilt"}  # a guard needs its encoder
    with pytest.raises(Refused, match="your file leaves out"):
        jiwy.act("add", {**ENCODER, "name": "encoder_tilt"})
    state = jiwy.act("unset", {"paths": [["components", "encoder_tilt"], ["components", "guard_tilt"]]})
    assert state["forms"]["left_out"] == []
    state = jiwy.act("rename", {"component": "pwm_tilt", "name": "motor_tilt"})
    assert state["forms"]["left_out"] == ["pwm_tilt"]
    assert [end["reference"] for end in state["wires"]["pwm_tilt"]] == ["motor_tilt"]
    assert state["forms"]["values"]["components.guard_tilt.actuator"]["text"] == "motor_tilt"


def test_files_that_name_a_component_are_listed(jiwy: Session, new_project: Path) -> None:
    file = new_project / "moves.yaml"
    file.write_text("version: 1\nevents: [{at: 1 s, set: {encoder_pan: 1}}]\n")
    state = fill(jiwy, "control.overrun_limit", "3")
    file.unlink()
    assert state["users"]["encoder_pan"]["files"] == ["moves.yaml"]
    assert state["users"]["encoder_tilt"]["files"] == []


def test_a_value_without_a_field_is_refused(axis: Session) -> None:
    with pytest.raises(Refused, match="there is no value 'target'"):
        fill(axis, "target", "host")
    with pytest.raises(Refused, match=r"there is no value 'components\.position_x\.kind'"):
        fill(axis, "components.position_x.kind", "pwm")
    for path in (["target"], ["components"], ["parameters"], ["components", "nobody", "kind"]):
        with pytest.raises(Refused, match="there is no value"):
            axis.act("take_back", {"path": path})


@pytest.fixture
def shared(tmp_path: Path) -> Iterator[tuple[Session, Path]]:
    """A project with a second target, whose .tcf extends the first one's."""
    folder = with_second_target(own_axis_project(tmp_path))
    session = session_of(folder)
    yield session, folder
    session.ended.set()


def test_errors_in_other_targets_are_shown_before_saving(shared: tuple[Session, Path]) -> None:
    session, folder = shared
    before = (folder / "robot.tcf").read_text()
    assert session.state()["forms"]["shared"] == ["second"]
    fill(session, "control.overrun_limit", "3")
    session.act("save", {})  # is no error anywhere
    session.act("connect", {"port": "setpoint_x", "ends": [{"reference": "end_x"}]})
    session.act("remove", {"component": "position_x"})
    with pytest.raises(Refused, match="saving makes errors in other targets: second") as refused:
        session.act("save", {})
    assert refused.value.status == 409
    state = session.state()
    assert state["draft"]["changed"] and "position_x" in (folder / "robot.tcf").read_text()
    (asked,) = state["ask"]
    assert asked["target"] == "second" and "there is no component 'position_x'" in asked["errors"][0]["message"]
    assert session.act("undo", {})["ask"] == []
    session.act("redo", {})
    state = session.act("save", {"agreed": True})
    assert state["ask"] == [] and not state["draft"]["changed"]
    assert (folder / "robot.tcf").read_text() != before
    fill(session, "control.overrun_limit", "4")
    assert not session.act("save", {})["draft"]["changed"]  # the second target had this error before


def test_the_other_target_can_be_opened(shared: tuple[Session, Path]) -> None:
    session, _ = shared
    state = session.act("open", {"target": "second"})
    assert state["forms"]["shared"] == []
    assert state["forms"]["values"]["components.position_x.topic"]["how"] == "file"


def test_a_parameter_of_the_model_is_set_in_the_bindings(jiwy: Session, new_project: Path) -> None:
    (section,) = [each for each in jiwy.state()["forms"]["settings"] if each["title"].startswith("Parameters")]
    name, exported = section["fields"][0]["name"], section["fields"][0]["default"]
    path = ["parameters", name]
    body = {"changes": [{"path": path, "text": "2.5"}]}
    state = jiwy.act("fill", body)
    assert problems(state) == [] and len(diff(state)) == 2
    assert diff(state)[0] == "+parameters:" and diff(state)[1].endswith(": 2.5") and float(exported) != 2.5
    assert state["forms"]["values"][f"parameters.{name}"]["file"] == str(new_project / "robot.bindings.yaml")
    with pytest.raises(Refused, match="'fast' is not a number"):
        jiwy.act("fill", {"changes": [{"path": path, "text": "fast"}]})
    state = jiwy.act("take_back", {"path": path})
    assert diff(state) == [] and f"parameters.{name}" not in state["forms"]["values"]


def test_the_limits_of_a_parameter_stay(tmp_path: Path, new_project: Path) -> None:
    folder = Path(shutil.copytree(new_project, tmp_path / "robot"))
    bindings = folder / "robot.bindings.yaml"
    session = session_of(folder)
    (section,) = [each for each in session.state()["forms"]["settings"] if each["title"].startswith("Parameters")]
    name = section["fields"][0]["name"]
    dotted = name.replace("\\", ".")
    bindings.write_text(f"{bindings.read_text()}parameters:\n  {dotted}: {{value: 1, minimum: 0, maximum: 3}}\n")
    path = ["parameters", name]
    state = session.act("fill", {"changes": [{"path": path, "text": "2"}]})
    assert diff(state) == [
        f"-  {dotted}: {{value: 1, minimum: 0, maximum: 3}}",
        f"+  {dotted}: {{value: 2, minimum: 0, maximum: 3}}",
    ]
    state = session.act("fill", {"changes": [{"path": path, "text": "5"}]})
    assert [each["path"] for each in state["diagnostics"] if each["id"] == "out-of-range"] == [["parameters", dotted]]
