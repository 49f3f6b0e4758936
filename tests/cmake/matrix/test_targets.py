# SPDX-License-Identifier: Apache-2.0
"""epg_add_target with the oldest and the newest CMake, and with every generator: editors, build, run."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import pytest

from tests.cmake.matrix.cells import GENERATORS
from tests.cmake.matrix.cmakes import cmake
from tests.cmake.project import CMAKE_DIR, PROJECTS


@pytest.mark.parametrize("generator", GENERATORS)
@pytest.mark.parametrize("version", ["oldest", "newest"])
def test_target(version: str, generator: str, tmp_path: Path) -> None:
    program, build = cmake(version), tmp_path / "build"

    def run(*command: str | Path) -> str:
        done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
        assert done.returncode == 0, done.stdout
        return done.stdout

    arguments = (f"-DEPG_DIR={CMAKE_DIR}", f"-DPython3_EXECUTABLE={sys.executable}")
    output = run(program, "-S", PROJECTS / "robot", "-B", build, "-G", generator, *arguments)
    assert "warning" not in output.lower(), output

    # An editor reads compile_commands.json before the first build.
    entries = {entry["file"]: entry for entry in json.loads((build / "compile_commands.json").read_text())}
    assert {"robot_app.c", "controller.c", "main.c"} <= {Path(file).name for file in entries}
    for entry in entries.values():
        words = entry["command"].replace(" -o ", " -fsyntax-only -o ", 1)
        done = subprocess.run(words, shell=True, cwd=entry["directory"], capture_output=True, text=True)
        assert done.returncode == 0, f"{words}\n{done.stderr}"

    run(program, "--build", build, "--parallel", "2")
    (robot,) = build.rglob("robot_host")
    assert "500" in run(robot, "--duration", "0.5")
