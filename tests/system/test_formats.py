# SPDX-License-Identifier: Apache-2.0
"""A target of a system starts again as at first, with models of each format that test_simulation.py does not have."""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path

import pytest

from tests.cmake.project import ROOT, Project
from tests.system.test_simulation import rows

SYSTEM = """version: 1
system: formats
targets:
  fmi_2: {tcf: robot.tcf, model: fmu2, bindings: fmi_2.yaml}
  fmi_3: {tcf: robot.tcf, model: fmu3, bindings: fmi_3.yaml}
  hand: {tcf: robot.tcf, model: pid_c, bindings: hand.yaml}
  tokens: {tcf: robot.tcf, model: tokens.xml, bindings: tokens.yaml}
world: {sends: [fmi_2/setpoint, fmi_2/whole, fmi_3/setpoint, fmi_3/whole, hand/setpoint, hand/whole,
                tokens/setpoint, tokens/whole]}
"""
ROBOT = """version: 1
target: rpi_pico_bare_metal
node: robot
control: {enable_at_start: true}
communication: {middleware: xrce}
components:
  encoder: {kind: quadrature_encoder, pins: {a: 10, b: 11}, counts_per_revolution: 4096}
  motor: {kind: pwm_h_bridge, pins: {value: 2, direction_a: 7, direction_b: 8}, frequency: 20 kHz}
  on: {kind: digital_input, pins: {value: 3}, pull: up}
  setpoint: {kind: ros_subscriber, unit: rad, initial: 0.3}
  whole: {kind: ros_subscriber, type: int32, initial: 5}
"""
FILES = {
    "formats.system.yaml": SYSTEM,
    "robot.tcf": ROBOT,
    "CMakeLists.txt": """cmake_minimum_required(VERSION 3.22)
project(formats LANGUAGES C)
find_package(EPG REQUIRED)
epg_add_system(formats SYSTEM formats.system.yaml)
""",
    "fmi_2.yaml": """version: 1
model: Servo "1"
inputs: {plant.setpoint: setpoint, plant.position: encoder, enable: on, mode: whole}
outputs: {duty: motor, steps: unconnected, saturated: unconnected}
""",
    "fmi_3.yaml": """version: 1
model: Axes
inputs: {"setpoint[1]": setpoint, "setpoint[2]": setpoint, "setpoint[3]": encoder,
         gain: setpoint, mask: whole, hold: on}
outputs: {"duty[1]": motor, "duty[2]": unconnected, "duty[3]": unconnected, count: unconnected, held: unconnected}
""",
    "hand.yaml": """version: 1
model: pid
inputs: {setpoint: setpoint, position: encoder, enable: on, limit: whole}
outputs: {duty: motor, steps: unconnected, saturated: unconnected}
""",
    "tokens.yaml": """version: 1
model: Turntable_Control
inputs: {setpoint: setpoint, position: encoder}
outputs: {duty: motor, error_logging: unconnected}
""",
}
STOP, START, END = 1.0, 1.0503, 2.0


@pytest.fixture(scope="module")
def traces(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The traces of a run in which each target dies and starts again."""
    project = Project(tmp_path_factory.mktemp("formats"), "formats")
    models = ROOT / "tests/models"
    for name in ("fmu2", "fmu3", "pid_c"):
        shutil.copytree(models / name, project.source / name)
    shutil.copy(ROOT / "examples/existing_firmware/station/model/tokens.xml", project.source)
    for name, text in FILES.items():
        (project.source / name).write_text(text)
    project.configure()
    project.build()
    events = project.folder / "events.csv"
    names = ("fmi_2", "fmi_3", "hand", "tokens")
    lines = [f"{STOP},{name},die\n{START},{name},restart\n" for name in names]
    events.write_text("time,target,event\n" + "".join(lines))
    command: list[str | Path] = [project.build_folder / "formats", "--duration", str(END), "--events", events]
    subprocess.run([*command, "--trace", project.folder], check=True, stdout=subprocess.DEVNULL)
    return project.folder


@pytest.mark.parametrize(
    ("name", "changing"),
    [("fmi_2", "outputs.steps"), ("fmi_3", "outputs.count"), ("hand", "outputs.steps"), ("tokens", "outputs.duty")],
)
def test_a_restart_is_a_first_start(name: str, changing: str, traces: Path) -> None:
    lives: tuple[list[list[str]], list[list[str]]] = ([], [])
    seen = set()
    for row in rows(traces / f"{name}.csv"):
        time = float(row.pop("time"))
        lives[time >= START].append(list(row.values()))
        seen.add(row[changing])
    shorter = min(map(len, lives))
    assert shorter > 450 and len(seen) > 100, "the state of the model changes"
    assert lives[0][:shorter] == lives[1][:shorter]
