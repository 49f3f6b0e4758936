# SPDX-License-Identifier: Apache-2.0
"""``epg new``: the project that it writes, its use of the model, and the files that it does not change."""

from __future__ import annotations

import json
import os
import re
import shutil
import signal
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

import epg
from epg.cli.main import main
from epg.generator.data import targets_roots
from epg.generator.diagnostics import Diagnostics
from epg.generator.documents.yaml_file import load_yaml
from epg.generator.emit.folder import write_folder
from epg.generator.tools.tools import load_tools
from tests.cmake.project import snapshot

ROOT = Path(__file__).resolve().parent.parent.parent
JIWY = ROOT / "examples/jiwy/model"
RELBOT = ROOT / "examples/relbot/model"
TURNTABLE = ROOT / "examples/existing_firmware/station/model"
TARGETS = [
    "rpi_pico_bare_metal",
    "rpi_pico2_freertos",
    "host",
    "rpi_pico_bare_metal_jiwy",
    "rpi_pico_freertos_jiwy",
    "rpi_pico2_bare_metal_jiwy",
    "rpi_pico2_freertos_jiwy",
    "host_jiwy",
    "firmware",
    "nucleo_h743zi_bare_metal",
    "nucleo_h743zi2_freertos",
    "nucleo_h743zi_bare_metal_jiwy",
    "nucleo_h743zi_freertos_jiwy",
]
EXTENSION_HEADER = "# == DO NOT EDIT THE FOLLOWING LINES for the Raspberry Pi Pico VS Code Extension to work =="


def new(folder: Path, target: str, model: Path = JIWY, *options: str) -> int:
    return main(["new", str(folder), "--target", target, "--model", str(model), *options])


def check(folder: Path, name: str, model: str = "model") -> int:
    files = ["--tcf", str(folder / f"{name}.tcf"), "--bindings", str(folder / f"{name}.bindings.yaml")]
    return main(["check", *files, "--model", str(folder / model)])


@pytest.fixture(scope="module")
def projects(tmp_path_factory: pytest.TempPathFactory) -> Callable[[str], Path]:
    """The project for a target, which is written once."""
    written: dict[str, Path] = {}

    def project(target: str) -> Path:
        if target not in written:
            folder = tmp_path_factory.mktemp("project") / "robot"
            assert new(folder, target) == 0
            written[target] = folder
        return written[target]

    return project


@pytest.mark.parametrize("target", TARGETS)
def test_a_project_is_complete_and_right(
    target: str, projects: Callable[[str], Path], capsys: pytest.CaptureFixture[str]
) -> None:
    folder = projects(target)
    assert "to bind" not in capsys.readouterr().out
    assert check(folder, "robot") == 0
    assert capsys.readouterr() == ("no errors\n", "")
    assert main(["check", str(folder / "robot.tcf")]) == 0
    assert "enable_at_start: false" in (folder / "robot.tcf").read_text()
    names = set(snapshot(folder))
    assert {"README.md", "CMakeLists.txt", "CMakePresets.json", "epg_import.cmake", ".gitignore"} <= names
    if target.startswith("rpi"):
        assert {"pico_sdk_import.cmake", ".vscode/launch.json"} <= names
    if target.startswith("nucleo"):
        assert {".vscode/launch.json", ".vscode/tasks.json"} <= names
    if not target.startswith("host"):
        assert "simulation/CMakeLists.txt" in names
        assert main(["check", str(folder / "simulation/robot_host.tcf")]) == 0


@pytest.mark.parametrize("target", TARGETS)
def test_enabling_is_for_people(target: str, projects: Callable[[str], Path]) -> None:
    """For any configuration of the robot: a new project does not move anything without a command of the user."""
    from epg.generator.catalog.catalog import load_catalog
    from epg.generator.project import Request, load_configuration
    from epg.new.new_project import ProjectRequest

    folder = projects(target)
    request = ProjectRequest(None, folder, target, JIWY)
    catalog = load_catalog(request.roots, Diagnostics())
    found = load_configuration(Request("robot", str(folder / "robot.tcf"), JIWY, JIWY), catalog, Diagnostics())
    assert found is not None
    assert found.control.enable_at_start is False
    assert found.communication.middleware.builds


@pytest.mark.parametrize("target", ["rpi_pico2_freertos_jiwy", "rpi_pico_bare_metal", "host"])
def test_two_runs_write_the_same_bytes(target: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    projects = []
    for place in ("one", "another place"):
        (tmp_path / place).mkdir()
        monkeypatch.chdir(tmp_path / place)
        monkeypatch.setenv("TMPDIR", str(tmp_path / place))
        assert new(Path("robot"), target) == 0
        projects.append(snapshot(Path("robot")))
        assert sorted(entry.name for entry in (tmp_path / place).iterdir()) == ["robot"], "nothing else is left"
    assert projects[0] == projects[1]
    for name, data in projects[0].items():
        assert str(tmp_path).encode() not in data
        assert str(ROOT).encode() not in data
        assert b"\r" not in data or name.startswith("model/")
        assert data.endswith(b"\n"), name


def test_json(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    folder = tmp_path / "my robot"
    assert new(folder, "rpi_pico_freertos_jiwy", JIWY, "--json") == 0
    data = json.loads(capsys.readouterr().out)
    assert data["files"] == sorted(snapshot(folder))
    del data["files"]
    assert data == {
        "folder": folder.as_posix(),
        "name": "my_robot",
        "target": "rpi_pico_freertos",
        "model": "model",
        "model_copied": True,
        "open": [],
    }


def test_errors_as_json(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert new(tmp_path / "robot", "nonsense", JIWY, "--json") == 1
    assert json.loads(capsys.readouterr().out)["diagnostics"][0]["id"] == "unknown-target"
    assert not (tmp_path / "robot").exists()


# names and places -----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("folder", "name"), [("my robot", "my_robot"), ("2nd-robot", "robot_2nd_robot"), ("Größe", "Gr_e"), ("--", "robot")]
)
def test_the_name_is_an_identifier(folder: str, name: str, tmp_path: Path) -> None:
    assert new(tmp_path / folder, "rpi_pico2_bare_metal") == 0
    assert (tmp_path / folder / f"{name}.tcf").is_file()
    assert f"project({name}_firmware C CXX ASM)" in (tmp_path / folder / "CMakeLists.txt").read_text()


def test_a_name_of_ones_own(tmp_path: Path) -> None:
    assert new(tmp_path / "robot", "host", JIWY, "--name", "pan_tilt") == 0
    assert (tmp_path / "robot/pan_tilt.bindings.yaml").is_file()
    assert new(tmp_path / "another", "host", JIWY, "--name", "string") == 1, "its header would hide the C library's"
    assert not (tmp_path / "another").exists()


@pytest.mark.skipif(os.name == "nt", reason="EPG: Windows has no such names")
@pytest.mark.parametrize(
    "folder", ["a|b", "a${X}b", "a$ENV{HOME}b", "a$(id)b", "a#b", "a[b", "a]]b[[", "a?b", "a;b", 'a"b', "a:b"]
)
def test_a_folder_that_cmake_cannot_use_is_refused(
    folder: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert new(tmp_path / folder / "robot", "host") == 1
    said = capsys.readouterr().err
    assert f"{folder}/robot' cannot be the folder of a project: " in said and "hint: choose another folder" in said
    assert list(tmp_path.iterdir()) == []


@pytest.mark.skipif(os.name == "nt", reason="EPG: Windows has no such names")
def test_a_folder_with_other_signs_is_fine(tmp_path: Path) -> None:
    assert new(tmp_path / "a $b {c} @d@ %e & (f) 'g' [1] ~=,^!" / "robot", "host") == 0


def test_folders_above_are_made(tmp_path: Path) -> None:
    assert new(tmp_path / "a/b/robot", "host") == 0
    assert (tmp_path / "a/b/robot/CMakeLists.txt").is_file()


# the model ------------------------------------------------------------------------------------------------------------


def test_a_model_elsewhere_is_copied_with_all_that_it_needs(tmp_path: Path) -> None:
    export = shutil.copytree(RELBOT, tmp_path / "export")
    (export / "notes.txt").write_text("not the model's")
    assert new(tmp_path / "robot", "host", export) == 0
    assert (tmp_path / "robot/model/common/xxtypes.h").read_bytes() == (RELBOT / "common/xxtypes.h").read_bytes()
    assert not (tmp_path / "robot/model/notes.txt").exists()
    shutil.rmtree(export)
    assert check(tmp_path / "robot", "robot") == 0


def test_a_note_about_a_model_that_is_copied_comes_once(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    export = tmp_path / "export"
    shutil.copytree(JIWY, export / "src")
    (export / "common").mkdir()
    (export / "src/xxtypes.h").rename(export / "common/xxtypes.h")
    assert new(tmp_path / "robot", "host", export) == 0
    said = capsys.readouterr().err
    assert said.count("[model-neighbour]") == 1, said


def test_a_model_in_the_project_stays_where_it_is(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    folder = tmp_path / "robot"
    shutil.copytree(JIWY, folder / "my model; $x")
    before = snapshot(folder)
    assert new(folder, "rpi_pico2_freertos_jiwy", folder / "my model; $x") == 0
    after = snapshot(folder)
    assert {name: after[name] for name in before} == before
    assert not (folder / "model").exists()
    assert '  MODEL "my model\\; \\$x"\n' in after["CMakeLists.txt"].decode()
    assert '  MODEL "../my model\\; \\$x"\n' in after["simulation/CMakeLists.txt"].decode()
    capsys.readouterr()
    assert check(folder, "robot", "my model; $x") == 0


def test_a_scenario_has_the_units_of_the_ports(tmp_path: Path) -> None:
    export = shutil.copytree(ROOT / "tests/models/pid_c", tmp_path / "pid")
    text = (export / "model.yaml").read_text()
    units = {"rad": "rad", "m/s": "m/s", "''": "none", "'\"}: %'": "none"}
    for index, (unit, expected) in enumerate(units.items()):
        (export / "model.yaml").write_text(re.sub(r"(setpoint: \{)[^}]*", rf"\1unit: {unit}", text))
        assert new(tmp_path / f"robot{index}", "host", export) == 0
        scenario = load_yaml(tmp_path / f"robot{index}/scenario.yaml", Diagnostics())
        assert scenario is not None and scenario["axes"]["setpoint"]["unit"].value == expected


def test_a_file_can_name_the_model(tmp_path: Path) -> None:
    assert new(tmp_path / "robot", "host_jiwy", JIWY / "xxsubmod.c") == 0
    assert '  MODEL "model/xxsubmod.c"\n' in (tmp_path / "robot/CMakeLists.txt").read_text()
    assert check(tmp_path / "robot", "robot", "model/xxsubmod.c") == 0


def test_a_model_that_cannot_be_used_leaves_no_project(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "empty").mkdir()
    assert new(tmp_path / "robot", "host", tmp_path / "empty") == 1
    assert "[model-not-recognised]" in capsys.readouterr().err
    assert not (tmp_path / "robot").exists()


def test_ports_that_nobody_can_bind_are_named(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert new(tmp_path / "robot", "rpi_pico2_freertos_jiwy", TURNTABLE) == 0
    output = capsys.readouterr()
    assert "to bind: setpoint (in " in output.out
    assert output.err == "", "what is left to do is no error"
    assert "# setpoint:" in (tmp_path / "robot/robot.bindings.yaml").read_text()


def test_weak_matches_with_hardware_are_not_written(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """RELbot's ports share words with topics and hardware: only topics are bound; the user binds the others."""
    assert new(tmp_path / "robot", "host_relbot", RELBOT) == 0
    assert capsys.readouterr().err == ""
    assert check(tmp_path / "robot", "robot") == 1
    errors = [line for line in capsys.readouterr().err.splitlines() if ": error: " in line]
    assert len(errors) == 2 and all("[unbound-input]" in line and "'Pos" in line for line in errors)
    file = tmp_path / "robot/robot.bindings.yaml"
    text = file.read_text()
    assert "  SetPosLeft: left_subscriber\n" in text and "  LogRight: right_publisher\n" in text
    for port, component in (("Pos", "encoder"), ("Steer", "pwm")):
        assert f"{port}Left: {component}" not in text
        for side in ("Left", "Right"):
            text = re.sub(rf"^  # {port}{side}:.*$", f"  {port}{side}: {component}_{side.lower()}", text, flags=re.M)
    file.write_text(text)
    assert check(tmp_path / "robot", "robot") == 0


def test_what_does_not_fit_is_said_at_once(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """A step of 1.5 ms is not a multiple of JIWY's period of 1 ms: EPG writes the project and says what to change."""
    model = shutil.copytree(TURNTABLE, tmp_path / "odd")
    for file in model.iterdir():
        text = file.read_text()
        file.write_text(re.sub(r"\b0\.001\b", "0.0015", text))
    assert new(tmp_path / "robot", "rpi_pico_bare_metal_jiwy", model) == 1
    assert "[step-not-multiple]" in capsys.readouterr().err
    assert (tmp_path / "robot/robot.tcf").is_file()


MODEL_YAML = """version: 1
name: Odd
step: 1 ms
sources: [odd.c]
header: odd.h
functions: {step: odd_step}
types: {inputs: odd_inputs_t, outputs: odd_outputs_t}
inputs: {start: {}, epg_level: {}, on: {type: boolean}, level: {type: integer}}
outputs: {inputs: {}, status: {type: boolean}, velocity: {unit: rad/s}}
"""
ODD_H = """#include <stdbool.h>
typedef struct odd_inputs { double start; double epg_level; bool on; int level; } odd_inputs_t;
typedef struct odd_outputs { double inputs; bool status; double velocity; } odd_outputs_t;
void odd_step(const odd_inputs_t *in, odd_outputs_t *out);
"""
ODD_C = """#include "odd.h"
void odd_step(const odd_inputs_t *in, odd_outputs_t *out)
{
    out->inputs = in->start + in->level;
    out->status = in->on;
    out->velocity = 0.0;
}
"""


def test_a_model_that_is_called_after_its_folder(tmp_path: Path) -> None:
    model = tmp_path / "controller"
    model.mkdir()
    yaml = MODEL_YAML.replace("name: Odd\n", "").replace(", on: {type: boolean}, level: {type: integer}", "")
    for name, text in (("model.yaml", yaml), ("odd.h", ODD_H), ("odd.c", ODD_C)):
        (model / name).write_text(text)
    assert new(tmp_path / "robot", "host", model) == 0
    assert "model: model\n" in (tmp_path / "robot/robot.bindings.yaml").read_text()
    assert check(tmp_path / "robot", "robot") == 0


def test_ports_with_names_of_epgs_own(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """`robot_inputs`, `robot_start`, `epg_...` are EPG's; boolean and integer inputs get topics of their types."""
    model = tmp_path / "odd"
    model.mkdir()
    for name, text in (("model.yaml", MODEL_YAML), ("odd.h", ODD_H), ("odd.c", ODD_C)):
        (model / name).write_text(text)
    assert new(tmp_path / "robot", "rpi_pico_freertos", model) == 0
    output = capsys.readouterr()
    assert set(re.findall(r": (error|warning|note): .* \[(.*)\]$", output.err, re.MULTILINE)) == {
        ("note", "setpoint-without-unit")
    }
    assert "to bind" not in output.out
    assert "  level: {kind: ros_subscriber, topic: level, type: int32}\n" in (tmp_path / "robot/robot.tcf").read_text()
    assert "  on: {kind: ros_subscriber, topic: on, type: bool}\n" in (tmp_path / "robot/robot.tcf").read_text()
    assert "  port_epg_level: {kind: ros_subscriber, " in (tmp_path / "robot/robot.tcf").read_text()
    assert check(tmp_path / "robot", "robot") == 0


# what is there --------------------------------------------------------------------------------------------------------


def test_nothing_is_replaced(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    folder = tmp_path / "robot"
    folder.mkdir()
    (folder / "README.md").write_text("mine")
    assert new(folder, "host_jiwy") == 1
    assert "README.md: error: this file exists [file-exists]" in capsys.readouterr().err
    assert snapshot(folder) == {"README.md": b"mine"}
    (folder / "README.md").unlink()
    (folder / "notes.txt").write_text("mine")
    assert new(folder, "host_jiwy") == 0
    assert (folder / "notes.txt").read_text() == "mine"
    before = snapshot(folder)
    assert new(folder, "host_jiwy") == 1
    assert snapshot(folder) == before


def test_a_file_in_the_place_of_a_folder(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "robot").write_text("mine")
    assert new(tmp_path / "robot", "host") == 1
    assert "robot: error: this file exists" in capsys.readouterr().err
    (tmp_path / "other").mkdir()
    (tmp_path / "other/.vscode").write_text("mine")
    assert new(tmp_path / "other", "host") == 1
    assert ".vscode: error: this file exists" in capsys.readouterr().err
    assert [entry.name for entry in (tmp_path / "other").iterdir()] == [".vscode"]


def test_in_the_folder_where_one_is(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    before = os.stat(".").st_ino
    assert main(["new", ".", "--name", "robot", "--target", "host", "--model", str(JIWY)]) == 0
    assert os.stat(tmp_path).st_ino == before and Path("CMakeLists.txt").is_file()


@pytest.mark.parametrize("present", [False, True])
def test_the_next_run_removes_what_a_killed_one_has_left(present: bool, tmp_path: Path) -> None:
    folder = tmp_path / "robot"
    if present:
        folder.mkdir()
        (folder / "notes.txt").write_text("mine")
    before = snapshot(tmp_path)
    killed = (
        "import os, signal\nfrom pathlib import Path\nfrom epg.generator.emit import folder\n"
        "folder._move = os.rename = lambda *_: os.kill(os.getpid(), signal.SIGKILL)\n"
        f"folder.write_folder(Path({str(folder)!r}), {{'a': b'1'}})\n"
    )
    result = subprocess.run([sys.executable, "-c", killed], env=os.environ | {"PYTHONPATH": str(ROOT)})
    assert result.returncode == -signal.SIGKILL and snapshot(tmp_path) != before
    write_folder(folder, {"a": b"1"})
    assert set(snapshot(tmp_path)) == {*before, "robot/a"}
    assert not any(name.startswith(".") for name in [*os.listdir(tmp_path), *os.listdir(folder)])


@pytest.mark.parametrize("present", [False, True])
@pytest.mark.parametrize("broken", [1, 3])
def test_a_project_is_whole_or_not_there(
    present: bool, broken: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    folder = tmp_path / "above/robot"
    if present:
        folder.mkdir(parents=True)
        (folder / "notes.txt").write_text("mine")
    before = snapshot(tmp_path)
    rename, count = os.rename, 0

    def full(source: Path, place: Path) -> None:
        nonlocal count
        count += 1
        if count == (broken if present else 1):
            raise OSError(28, "No space left on device", str(place))
        rename(source, place)

    monkeypatch.setattr(os, "rename", full)
    with pytest.raises(OSError):
        write_folder(folder, {"a": b"1", "sub/b": b"2", "sub/c/d": b"3"})
    assert snapshot(tmp_path) == before
    assert sorted(path.name for path in tmp_path.rglob("*")) == (["above", "notes.txt", "robot"] if present else [])


# the VS Code extension, versions ------------------------------------------------------------------------------------


def cmakelists(tmp_path: Path, target: str) -> str:
    assert new(tmp_path / "robot", target) == 0
    return (tmp_path / "robot/CMakeLists.txt").read_text()


@pytest.mark.parametrize(("target", "board"), [("rpi_pico_bare_metal", "pico"), ("rpi_pico2_freertos_jiwy", "pico2")])
def test_the_vs_code_extension_recognises_the_project(target: str, board: str, tmp_path: Path) -> None:
    """The extension (0.21) searches for these files, this header, and lines that match its regular expressions."""
    text = cmakelists(tmp_path, target)
    assert (tmp_path / "robot/pico_sdk_import.cmake").is_file(), "it is activated by this file"
    assert (tmp_path / "robot/.vscode").is_dir()
    assert "pico_sdk_init()" in text
    assert text.count(EXTENSION_HEADER) == 1
    assert re.search(r"^set\(PICO_BOARD\s+([^)]+)\)$", text, re.M)[1] == f'{board} CACHE STRING "Board type"'  # type: ignore[index]
    versions = [re.search(rf"^set\({name}Version\s+([^)]+)\)", text, re.M) for name in ("sdk", "toolchain", "picotool")]
    assert [found[1] for found in versions if found] == ["2.2.0", "14_2_Rel1", "2.2.0-a4"]
    assert re.search(r"project\(([^)\s]+)", text)[1] == "robot_firmware", "it debugs build/<project>.elf"  # type: ignore[index]
    assert "epg_add_executable(robot_firmware " in text


def test_choosing_another_sdk_in_the_extension_keeps_the_rest(tmp_path: Path) -> None:
    """The extension replaces everything from its header to the last line that matches a rule."""
    text = cmakelists(tmp_path, "rpi_pico2_freertos_jiwy")
    replaced = re.search(rf"^{re.escape(EXTENSION_HEADER)}.*# =+$", text, re.M | re.S)
    assert replaced
    kept = text.replace(replaced[0], "")
    for line in ("set(freertosVersion 11.3.0)", f"set(epgVersion {epg.__version__})", "set(PICO_BOARD", "project("):
        assert line in kept


@pytest.mark.parametrize(
    "target",
    ["rpi_pico_freertos", "rpi_pico2_freertos_jiwy", "rpi_pico_bare_metal", "nucleo_h743zi_freertos_jiwy", "host"],
)
def test_versions_stand_in_one_file(target: str, tmp_path: Path) -> None:
    text = cmakelists(tmp_path, target)
    stated = dict(re.findall(r"^set\((\w+)Version (.+)\)$", text, re.M))
    assert stated["epg"] == epg.__version__
    assert ("sdk" in stated) == target.startswith("rpi")
    assert ("cmsisDevice" in stated) == ("cmsisCore" in stated) == target.startswith("nucleo")
    assert ("freertos" in stated) == ("freertos" in target)
    tools = load_tools(targets_roots(), Diagnostics())
    parts = {
        "sdk": "pico_sdk",
        "freertos": "freertos_kernel",
        "cmsisCore": "cmsis_core",
        "cmsisDevice": "cmsis_device_h7",
    }
    for name, tool in parts.items():
        assert name not in stated or stated[name] == tools[tool].tested
    for name, data in snapshot(tmp_path / "robot").items():
        if name != "CMakeLists.txt" and not name.startswith("model/"):
            for version in stated.values():
                assert not re.search(rf"(?<![\d.]){re.escape(version)}(?![\d.])", data.decode()), name


def test_settings_for_editors_are_json(tmp_path: Path) -> None:
    for target in ("rpi_pico2_bare_metal", "nucleo_h743zi2_bare_metal", "host"):
        folder = tmp_path / target
        assert new(folder, target) == 0
        files = [*folder.glob(".vscode/*.json"), folder / "CMakePresets.json"]
        assert len(files) >= 3
        for file in files:
            json.loads(re.sub(r"^\s*//.*$", "", file.read_text(), flags=re.M))  # as VS Code reads it
    tasks = json.loads(
        re.sub(r"^\s*//.*$", "", (tmp_path / "rpi_pico2_bare_metal/.vscode/tasks.json").read_text(), flags=re.M)
    )
    assert {"Compile Project", "Run Project", "Flash"} <= {task["label"] for task in tasks["tasks"]}


def test_editors_find_the_schema_of_each_file(tmp_path: Path) -> None:
    """VS Code's YAML extension checks each file of a project, and the schema accepts it."""
    from fnmatch import fnmatch

    from jsonschema import Draft202012Validator

    for target in ("rpi_pico2_bare_metal", "nucleo_h743zi_freertos", "host_jiwy"):
        folder = tmp_path / target
        assert new(folder, target) == 0
        settings = json.loads((folder / ".vscode/settings.json").read_text())
        assert settings["files.associations"] == {"*.tcf": "yaml"}
        patterns = {
            pattern: json.loads((folder / place).read_text()) for place, pattern in settings["yaml.schemas"].items()
        }
        assert set(patterns) == {"*.tcf", "*bindings.yaml", "*scenario.yaml", "model.yaml", "*.system.yaml"}
        checked = 0
        for file in sorted(folder.rglob("*")):
            for pattern, schema in patterns.items():
                if fnmatch(file.name, pattern):
                    node = load_yaml(file, Diagnostics())
                    assert node is not None
                    assert list(Draft202012Validator(schema).iter_errors(node.plain())) == [], file
                    checked += 1
        assert checked >= 2


# texts for the user ---------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("target", ["rpi_pico_bare_metal", "rpi_pico2_freertos", "nucleo_h743zi_freertos", "host"])
def test_the_examples_in_a_fresh_configuration_are_right(target: str, tmp_path: Path) -> None:
    """The components in its comments are valid when they are uncommented."""
    assert new(tmp_path / "robot", target, TURNTABLE) == 0
    file = tmp_path / "robot/robot.tcf"
    text, count = re.subn(r"^  # (\w+: \{kind: )", r"  \1", file.read_text(), flags=re.M)
    text, more = re.subn(r"^  # (period: 1 ms|overrun_limit: 10) .*$", r"  \1", text, flags=re.M)
    assert count >= 3 and more == 2
    file.write_text(text)
    assert main(["check", str(file)]) == 0


@pytest.mark.parametrize("target", TARGETS)
def test_the_readme_names_files_that_are_there(target: str, projects: Callable[[str], Path]) -> None:
    folder = projects(target)
    readme = (folder / "README.md").read_text()
    table = re.findall(r"^\| (`.+?) \|", readme, re.M)
    assert len(table) >= 6
    for name in re.findall(r"`([^`]+)`", " ".join(table)):
        assert (folder / name).exists(), name
    for line in readme.splitlines():
        assert len(line) <= 130, line


def test_a_project_may_be_called_as_the_configuration_it_extends(tmp_path: Path) -> None:
    assert new(tmp_path / "host_jiwy", "host_jiwy") == 0
    assert "extends: host_jiwy.tcf" in (tmp_path / "host_jiwy/host_jiwy.tcf").read_text()
    assert check(tmp_path / "host_jiwy", "host_jiwy") == 0
