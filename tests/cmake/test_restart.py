# SPDX-License-Identifier: Apache-2.0
"""Models that are initialised again, whatever options a project has."""

from __future__ import annotations

import subprocess
from pathlib import Path

import pytest

from epg.runs.recording import read_table
from tests.cmake.project import ROOT, Project

LINK_TIME = "-flto -fcommon -fdata-sections -ffunction-sections"
ENABLING = ((0.1, 0), (0.11, 1), (0.2, 0), (0.22, 1))
PLACES = (f"-DEXAMPLES={ROOT / 'examples'}", f"-DWORN={ROOT / 'tests/models/worn'}")


@pytest.mark.parametrize(
    ("generator", "options"),
    [
        ("Ninja", ["-DCMAKE_BUILD_TYPE=Release"]),
        ("Unix Makefiles", ["-DCMAKE_C_FLAGS=-fsanitize=address,undefined", "-DCMAKE_CXX_FLAGS=-fsanitize=address"]),
        ("Ninja", ["-DCMAKE_INTERPROCEDURAL_OPTIMIZATION=ON", "-DCMAKE_UNITY_BUILD=ON"]),
        ("Unix Makefiles", [f"-DCMAKE_C_FLAGS={LINK_TIME}", "-DCMAKE_EXE_LINKER_FLAGS=-Wl,--gc-sections"]),
        ("Ninja Multi-Config", []),
    ],
    ids=["release", "sanitizers", "lto-and-unity", "lto-and-sections", "multi-config"],
)
def test_a_second_run_is_the_first(generator: str, options: list[str], tmp_path: Path) -> None:
    project = Project(tmp_path, "restart")
    project.configure(*PLACES, *options, generator=generator)
    project.build("--target", "twice")
    (program,) = (path for path in project.build_folder.rglob("twice") if path.is_file())
    done = subprocess.run([program], capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr
    worn, wheels = (tuple(map(float, line.split())) for line in done.stdout.splitlines())
    assert 0 < worn[0] < worn[1]
    assert wheels[0] != wheels[1]
    assert "model-variables" not in project.build("--target", "twice"), "nothing has changed"


def test_a_target_that_is_enabled_again(tmp_path: Path) -> None:
    """Through the control cycle of the platform host, in simulated time."""
    project = Project(tmp_path, "restart")
    project.configure(*PLACES)
    project.build("--target", "robot_host")
    events = tmp_path / "events.csv"
    events.write_text("time,topic,value\n" + "".join(f"{t},$enable,{v}\n" for t, v in ENABLING))
    trace = tmp_path / "trace.csv"
    command = [project.build_folder / "robot_host", "--duration=0.3", f"--setpoints={events}", f"--trace={trace}"]
    subprocess.run([*command, "--quiet"], check=True)
    worn = read_table(trace).signals["outputs.worn"].value
    runs = [list(worn[start : start + 50]) for start in (0, 110, 220)]
    assert runs[0][0] < runs[0][-1]
    assert runs[1:] == [runs[0], runs[0]]


def test_a_model_that_cannot_be_restarted_fails_the_build(tmp_path: Path) -> None:
    project = Project(tmp_path, "robot")
    project.edit("model/controller.c", "#include", "_Thread_local int steps_of_thread = 3;\n#include")
    project.configure()
    output = project.build(check=False)
    assert "controller.c.o: error: a second start of the model cannot be like its first" in output
    assert "variable 'steps_of_thread' exists once for each thread" in output
    assert "[model-not-restartable]" in output
    assert not list(project.build_folder.rglob("robot_firmware"))
