# SPDX-License-Identifier: Apache-2.0
"""A project moves to another board or platform: its .tcf, and the files that `epg new` has written for the old one."""

from __future__ import annotations

import os
import shutil
import subprocess
from pathlib import Path
from typing import Any

import pytest

from epg.cli.main import main
from epg.connect.body import Refused
from epg.connect.build.plan import make_plan
from epg.connect.editor import Editor
from epg.connect.projects import Job, find_jobs
from epg.generator.catalog.catalog import load_catalog
from epg.generator.data import targets_roots
from epg.generator.diagnostics import Diagnostics
from epg.generator.project import load_configuration
from epg.new.new_project import ProjectRequest, new_project
from tests.connect import robots
from tests.connect.page import session_of
from tests.connect.robots import ROOT, one_axis_project
from tests.doubles.toolchain import arm_gcc, pico_sdk, skip_if_missing

TCF = """# my axis
version: 1
target: rpi_pico2_bare_metal
node: axis # as in the other lab
clocks: {sys: 125 MHz}
control: {period: 1 ms, output_delay: 100 us, enable_at_start: false, enable_topic: enable}
communication: {middleware: xrce, transport: usb, console: true, period: 33 ms, usb: {serial: A1}}
components:
  encoder: # on the motor's shaft
    kind: quadrature_encoder
    pins: {a: GP10, b: GP11}
    counts_per_revolution: 2000
  motor: {kind: pwm_h_bridge, pins: {value: GP2, direction_a: GP7, direction_b: GP8}, frequency: 20 kHz}
  setpoint: {kind: ros_subscriber, topic: setpoint}
"""
BINDINGS = """version: 1
model: model
inputs: {position_pan: encoder, setpoint_pan: setpoint}
outputs: {pwm_pan: motor}
"""


@pytest.fixture
def axis(tmp_path: Path) -> Path:
    return write_axis(tmp_path)


def write_axis(tmp_path: Path) -> Path:
    """The project of one axis on a Pico 2, with components of its own."""
    folder = one_axis_project(tmp_path, "rpi_pico2_bare_metal")
    (folder / "robot.tcf").write_text(TCF)
    (folder / "robot.bindings.yaml").write_text(BINDINGS)
    return folder


def editor_of(folder: Path) -> Editor:
    """The state of a session without its list of all targets, which takes a second to read."""
    (job,) = find_jobs(folder, Diagnostics())
    return Editor(job)


def listed(editor: Editor, target: str) -> tuple[dict[str, dict[str, str]], dict[str, str]]:
    """The changes of values, as texts by what happens and by key; and what happens to each file."""
    move = editor.plan_move(target).data()
    values: dict[str, dict[str, str]] = {}
    for item in move["items"]:
        after = f"{item['before']} -> {item['after']}" if item["what"] == "changed" else item["before"]
        values.setdefault(item["what"], {})[item["key"]] = after
    return values, {file["name"]: file["what"] for file in move["files"]}


def moved(editor: Editor, target: str) -> dict[str, Any]:
    editor.edit(editor.plan_move(target).operation)
    editor.save(anyway=False)
    return editor.show()


def is_checked(folder: Path) -> bool:
    files = ["--tcf", str(folder / "robot.tcf"), "--model", str(folder / "model")]
    return main(["check", *files, "--bindings", str(folder / "robot.bindings.yaml")]) == 0


def same_as_new(folder: Path, target: str) -> None:
    """All files of a new project for ``target`` are in the folder, except those of the user."""
    request = ProjectRequest("robot", folder, target, folder / "model", "xrce")
    project = new_project(request, Diagnostics())
    assert project is not None
    for name, data in project.files.items():
        if name not in ("robot.tcf", "robot.bindings.yaml"):
            assert (folder / name).read_bytes() == data, name


def test_to_another_family(axis: Path, capsys: pytest.CaptureFixture[str]) -> None:
    editor = editor_of(axis)
    files = {path: path.read_bytes() for path in axis.rglob("*") if path.is_file()}
    values, changes = listed(editor, "nucleo_h743zi_freertos")
    assert values["dropped"] == {"clocks.sys": "125 MHz"}
    assert "asked" not in values
    pins = {key for key in values["changed"] if ".pins." in key}
    assert len(pins) == 5 and values["changed"]["target"] == "rpi_pico2_bare_metal -> nucleo_h743zi_freertos"
    assert {"components.encoder", "control.output_delay", "communication.transport", "node"} <= values["kept"].keys()
    assert changes["CMakeLists.txt"] == "written" and changes["pico_sdk_import.cmake"] == "removed"
    assert {path: path.read_bytes() for path in axis.rglob("*") if path.is_file()} == files, "only listed so far"

    state = moved(editor, "nucleo_h743zi_freertos")
    assert [each for each in state["diagnostics"] if each["severity"] == "error"] == []
    text = (axis / "robot.tcf").read_text()
    for kept in ("# my axis\n", "node: axis # as in the other lab\n", "  encoder: # on the motor's shaft\n"):
        assert kept in text
    assert "clocks" not in text and "GP" not in text
    same_as_new(axis, "nucleo_h743zi_freertos")
    assert is_checked(axis), capsys.readouterr().err
    assert (axis / "robot.bindings.yaml").read_text() == BINDINGS

    editor.undo()
    editor.save(anyway=False)
    assert {path: path.read_bytes() for path in axis.rglob("*") if path.is_file()} == files, "one step takes all back"
    assert editor.draft.can_redo


def test_to_this_computer_and_back(axis: Path, capsys: pytest.CaptureFixture[str]) -> None:
    scenario = axis / "simulation/scenario.yaml"
    text = scenario.read_text() + "# mine\n"
    scenario.write_text(text)
    editor = editor_of(axis)
    values, changes = listed(editor, "host")
    assert values["changed"] == {
        "target": "rpi_pico2_bare_metal -> host", "communication.transport": "usb -> udp",
    }  # fmt: skip
    assert changes["scenario.yaml"] == "written"
    moved(editor, "host")
    assert is_checked(axis), capsys.readouterr().err
    assert (axis / "scenario.yaml").read_text() == text, "the user's scenario, not a new one"
    moved(editor, "rpi_pico2_bare_metal")
    assert is_checked(axis), capsys.readouterr().err
    assert "{a: GP10, b: GP11}" in (axis / "robot.tcf").read_text(), "a computer without pins keeps them"


def test_twice_before_it_is_saved(axis: Path) -> None:
    editor = editor_of(axis)
    editor.edit(editor.plan_move("host").operation)
    moved(editor, "nucleo_h743zi_freertos")
    same_as_new(axis, "nucleo_h743zi_freertos")


def test_pins_that_fit_are_kept(axis: Path) -> None:
    values, _ = listed(editor_of(axis), "rpi_pico_freertos")
    assert values["changed"] == {"target": "rpi_pico2_bare_metal -> rpi_pico_freertos"}


def test_to_zephyr(axis: Path) -> None:
    """The names of a USB device are settings of the build there; west builds the project then."""
    editor = editor_of(axis)
    values, changes = listed(editor, "rpi_pico2_zephyr")
    assert values["dropped"] == {"communication.usb": "serial: A1"}
    assert [name for name, what in changes.items() if what == "written"] == [
        "CMakeLists.txt", "README.md", "prj.conf", "src/main.c", "west.yml",
    ]  # fmt: skip
    session = session_of(axis)
    session.act("choose", {"configuration": "rpi_pico2_zephyr"})
    state = session.act("save", {})
    assert state["draft"]["external"] is None, "no other program has changed the files"
    (job,) = find_jobs(axis, Diagnostics())
    assert job.built_by == "west"
    assert session.act("undo", {})["draft"]["changed"], "the step can still be undone"
    with pytest.raises(Refused, match="rpi_pico_bare_metal_jiwy"):
        session.move("rpi_pico_bare_metal_jiwy")


def test_a_file_of_the_user_is_left_and_the_lines_are_told(axis: Path) -> None:
    cmake = axis / "CMakeLists.txt"
    text = cmake.read_text().replace("C CXX ASM)", "C CXX ASM) # mine")
    cmake.write_text(text)
    (axis / "README.md").unlink()
    editor = editor_of(axis)
    files = editor.plan_move("nucleo_h743zi_freertos").data()["files"]
    (asked,) = [file for file in files if file["what"] == "asked"]
    assert asked["name"] == "CMakeLists.txt"
    assert "-include(pico_sdk_import.cmake)" in asked["lines"] and "+epg_import_stm32()" in asked["lines"]
    moved(editor, "nucleo_h743zi_freertos")
    assert cmake.read_text() == text
    assert "Nucleo" in (axis / "README.md").read_text()


def test_what_no_rule_corrects_is_asked(axis: Path) -> None:
    """A mistake that was there before is not one of the move."""
    text = TCF.replace("rpi_pico2_bare_metal", "nucleo_h743zi_bare_metal").replace("20 kHz", "1 Hz")
    text = text.replace("clocks: {sys: 125 MHz}", "clocks: {core: 400 MHz}")
    for old, new in (("GP10", "PA5"), ("GP11", "PB3"), ("GP2", "PA3"), ("GP7", "PA6"), ("GP8", "PB8")):
        text = text.replace(old, new)
    (axis / "robot.tcf").write_text(text)
    (axis / "robot.bindings.yaml").write_text(BINDINGS.replace("pwm_pan: motor", "pwm_pam: motor"))
    editor = editor_of(axis)
    assert {each["id"] for each in editor.show()["diagnostics"]} >= {"unknown-port"}
    items = editor.plan_move("rpi_pico_bare_metal").data()["items"]
    asked = {item["key"]: item["reason"] for item in items if item["what"] == "asked"}
    assert all(key.startswith("components.motor.") for key in asked), asked
    assert "1 Hz" in asked["components.motor.frequency"]
    changed = {item["key"] for item in items if item["what"] == "changed"}
    assert changed == {"target", "components.encoder.pins.a", "components.encoder.pins.b"}


def test_another_computer_for_a_known_robot(tmp_path: Path) -> None:
    """The plant of a host's project is not in the call of a board's project, but in its simulation."""
    folder = tmp_path / "robot"
    model = Path(shutil.copytree(ROOT / "examples/jiwy/model", tmp_path / "camera"))
    robots.new_project(folder, "host_jiwy", model)
    editor = editor_of(folder)
    values, changes = listed(editor, "rpi_pico_bare_metal_jiwy")
    assert values["changed"] == {"extends": "host_jiwy.tcf -> rpi_pico_bare_metal_jiwy.tcf"}
    assert "asked" not in values
    assert changes["simulation/plant.bindings.yaml"] == "written"
    state = moved(editor, "rpi_pico_bare_metal_jiwy")
    assert state["diagnostics"] == []
    new = robots.new_project(tmp_path / "new", "rpi_pico_bare_metal_jiwy", model)
    for path in new.rglob("*"):
        if path.is_file() and path.name != "robot.tcf":
            assert (folder / path.relative_to(new)).read_bytes() == path.read_bytes(), path


def test_a_build_folder_of_another_target_is_made_again(axis: Path) -> None:
    """CMake's cache keeps the compiler and the board, so it is removed first."""
    skip_if_missing(arm_gcc, pico_sdk)
    build = axis / "build"
    (build / "epg/robot").mkdir(parents=True)
    (build / "CMakeCache.txt").write_text(f"CMAKE_HOME_DIRECTORY:INTERNAL={axis}\n")
    (build / "epg/robot/robot.json").write_text('{"target": {"name": "host"}}')
    (job,) = find_jobs(axis, Diagnostics())
    first = make_plan(job, configuration(job)).steps[0]
    assert first.command[1:] == ("-E", "rm", "-rf", str(build / "CMakeCache.txt"), str(build / "CMakeFiles"))
    (build / "epg/robot/robot.json").write_text('{"target": {"name": "rpi_pico2_bare_metal"}}')
    assert "-E" not in make_plan(job, configuration(job)).steps[0].command


def configuration(job: Job) -> Any:
    return load_configuration(job.request, load_catalog(targets_roots(()), Diagnostics()), Diagnostics())


@pytest.mark.parametrize("target", ["nucleo_h743zi_freertos", "host"])
def test_the_moved_project_builds(target: str, axis: Path) -> None:
    """In the build folder of the old target by EPG's own commands, and in a new one by those that a user types."""
    skip_if_missing(arm_gcc, pico_sdk)
    session = session_of(axis)
    for name in ("rpi_pico2_bare_metal", target):
        session.act("choose", {"configuration": name})
        state = session.act("generate", {})
        if state["build"]["ask"]:
            state = session.act("generate", {"run": state["build"]["ask"]["key"]})
        while state["build"]["state"] == "running":
            state = session.wait(state["version"], 60)
        assert state["build"]["state"] == "done", state["build"]["messages"]
        assert state["build"]["products"]
    environment = {**os.environ, "EPG_PATH": str(ROOT)}
    for command in (["cmake", "-B", "fresh"], ["cmake", "--build", "fresh"]):
        subprocess.run(command, cwd=axis, env=environment, check=True, capture_output=True)
