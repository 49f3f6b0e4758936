# SPDX-License-Identifier: Apache-2.0
"""``epg new --system``: the project around the file of a system, and its scenario."""

from __future__ import annotations

import contextlib
import json
from pathlib import Path

import pytest

from epg.cli.main import main
from epg.generator.diagnostics import Diagnostics
from epg.simulate import load_scenario
from tests.cmake.project import copy_jiwy, snapshot

SYSTEM = """version: 1
system: robots
targets:
  leader: {tcf: rpi_pico_freertos_jiwy, model: model, bindings: jiwy.bindings.yaml,
           plant: plant, plant_bindings: plant.bindings.yaml}
  near: {tcf: host_jiwy, model: model, bindings: jiwy.bindings.yaml, plant: plant,
         plant_bindings: plant.bindings.yaml, set: {communication: {middleware: xrce}}}
  far: {tcf: rpi_pico2_bare_metal_jiwy, model: model, bindings: jiwy.bindings.yaml}
connections:
  - {from: leader/pan_publisher, to: [near/pan_subscriber, far/pan_subscriber], unit: deg}
  - {from: far/tilt_publisher, to: near/tilt_subscriber}
world: {sends: [leader/pan_subscriber, leader/tilt_subscriber, far/tilt_subscriber]}
"""
FILES = {".gitignore", "CMakeLists.txt", "CMakePresets.json", "README.md", "epg_import.cmake", "scenario.yaml"}


@pytest.fixture
def system(tmp_path: Path) -> Path:
    path = tmp_path / "robots/robots.system.yaml"
    path.parent.mkdir()
    copy_jiwy(path.parent, "model", "plant")
    path.write_text(SYSTEM)
    return path


def new(folder: Path, system: Path, *options: str) -> int:
    return main(["new", str(folder), "--system", str(system), *options])


def test_a_project_beside_the_file(system: Path, capsys: pytest.CaptureFixture[str]) -> None:
    before = snapshot(system.parent)
    assert new(system.parent, system) == 0
    assert "6 files of the system robots, for leader, near, far" in capsys.readouterr().out
    after = snapshot(system.parent)
    assert {name: after[name] for name in before} == before
    assert set(after) - set(before) == FILES
    lists = after["CMakeLists.txt"].decode()
    assert 'epg_add_system(robots SYSTEM "robots.system.yaml")' in lists
    assert "epg_add_simulation(robots_simulation EXECUTABLE robots SCENARIO scenario.yaml)" in lists


def test_the_scenario_moves_the_axes_of_the_plants(system: Path) -> None:
    """`far` has no plant: its axes cannot be seen, and nothing can follow its plant."""
    assert new(system.parent, system) == 0
    diagnostics = Diagnostics()
    scenario = load_scenario(system.parent / "scenario.yaml", diagnostics)
    assert scenario is not None and not list(diagnostics)
    assert set(scenario.profiles) == {"leader/pan_subscriber", "leader/tilt_subscriber"}
    axes = {axis.name: (axis.setpoint, axis.position, axis.duty, axis.unit) for axis in scenario.axes}
    pan, tilt = "leader/plant.outputs.angle_pan", "leader/plant.outputs.angle_tilt"
    assert axes == {
        "leader_pan_subscriber": ("leader/pan_subscriber", pan, "leader/plant.inputs.duty_pan", "rad"),
        "leader_tilt_subscriber": ("leader/tilt_subscriber", tilt, "leader/plant.inputs.duty_tilt", "rad"),
        "near_pan_subscriber": (pan, "near/plant.outputs.angle_pan", "near/plant.inputs.duty_pan", "rad"),
    }


def test_the_scenario_sends_a_topic_of_several_targets_once(system: Path) -> None:
    shared = "{topic: profile, to: [leader/tilt_subscriber, far/tilt_subscriber]}"
    text = SYSTEM.replace("leader/tilt_subscriber, far/tilt_subscriber", shared)
    without_plant, plant = "bindings: jiwy.bindings.yaml}", "plant: plant, plant_bindings: plant.bindings.yaml}"
    text = text.replace(without_plant, f"{without_plant[:-1]}, {plant}")
    system.write_text(text)
    assert new(system.parent, system) == 0
    scenario = load_scenario(system.parent / "scenario.yaml", Diagnostics())
    assert scenario is not None and set(scenario.profiles) == {"leader/pan_subscriber", "profile"}
    axes = {axis.name: axis.setpoint for axis in scenario.axes}
    assert (axes["leader_tilt_subscriber"], axes["far_tilt_subscriber"]) == ("profile", "profile")


def test_the_scenario_of_one_plant_for_several_targets(system: Path) -> None:
    """An axis belongs to the target to which its port of the plant is bound."""
    text = (
        SYSTEM.partition("targets:")[0]
        + """plant: {model: plant, bindings: split.plant.yaml}
targets:
  pan: {tcf: rpi_pico_freertos_jiwy, model: model, bindings: jiwy.bindings.yaml}
  tilt: {tcf: rpi_pico_freertos_jiwy, model: model, bindings: jiwy.bindings.yaml}
world: {sends: [pan/pan_subscriber, pan/tilt_subscriber, tilt/pan_subscriber, tilt/tilt_subscriber]}
"""
    )
    system.write_text(text)
    (system.parent / "split.plant.yaml").write_text("""version: 1
model: JIWY_Plant
inputs: {duty_pan: {from: pan/pwm_pan, scale: 1}, duty_tilt: tilt/pwm_tilt}
outputs: {angle_pan: [pan/encoder_pan, tilt/encoder_pan], angle_tilt: tilt/encoder_tilt}
""")
    assert new(system.parent, system) == 0
    scenario = load_scenario(system.parent / "scenario.yaml", Diagnostics())
    assert scenario is not None
    assert {axis.name: (axis.position, axis.duty) for axis in scenario.axes} == {
        "pan_pan_subscriber": ("pan/plant.outputs.angle_pan", "pan/plant.inputs.duty_pan"),
        "tilt_pan_subscriber": ("tilt/plant.outputs.angle_pan", None),
        "tilt_tilt_subscriber": ("tilt/plant.outputs.angle_tilt", "tilt/plant.inputs.duty_tilt"),
    }


def test_a_project_in_another_folder_and_without_plants(system: Path, capsys: pytest.CaptureFixture[str]) -> None:
    text = SYSTEM.replace(", plant: plant", "").replace("plant: plant, ", "").replace("plant: plant", "")
    system.write_text(
        text.replace("plant_bindings: plant.bindings.yaml,", "").replace("plant_bindings: plant.bindings.yaml", "")
    )
    folder = system.parent.parent / "build files/project"
    assert new(folder, system, "--json") == 0
    data = json.loads(capsys.readouterr().out)
    assert (data["name"], data["targets"]) == ("robots", ["leader", "near", "far"])
    assert set(data["files"]) == set(snapshot(folder)) == FILES - {"scenario.yaml"}
    assert 'SYSTEM "../../robots/robots.system.yaml")' in (folder / "CMakeLists.txt").read_text()
    assert "epg_add_simulation" not in (folder / "CMakeLists.txt").read_text()
    assert "No target has a plant" in (folder / "README.md").read_text()


def test_nothing_is_written_after_a_mistake(system: Path, capsys: pytest.CaptureFixture[str]) -> None:
    folder = system.parent / "project"
    system.write_text(SYSTEM.replace("far/tilt_publisher", "far/tild_publisher"))
    assert new(folder, system) == 1
    assert "did you mean 'tilt_publisher'" in capsys.readouterr().err
    assert not folder.exists()
    system.write_text(SYSTEM)
    (system.parent / "CMakeLists.txt").write_text("# mine\n")
    before = snapshot(system.parent)
    assert new(system.parent, system) == 1
    assert "this file exists" in capsys.readouterr().err
    assert snapshot(system.parent) == before


@pytest.mark.parametrize(
    ("options", "told"),
    [
        (["--system", "robots.yaml"], "the name of a system ends with .system.yaml"),
        (["--system", "a.system.yaml", "--target", "host"], "not allowed with argument"),
        (["--system", "a.system.yaml", "--model", "model"], "argument --model: not allowed with argument --system"),
        (["--target", "host"], "the following arguments are required: --model"),
        ([], "one of the arguments --target --system is required"),
    ],
)
def test_options_that_do_not_fit(options: list[str], told: str, capsys: pytest.CaptureFixture[str]) -> None:
    with contextlib.suppress(SystemExit):
        assert main(["new", "project", *options]) == 2
    assert told in capsys.readouterr().err
