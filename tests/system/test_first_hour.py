# SPDX-License-Identifier: Apache-2.0
"""The first commands of docs/systems.md, as a new user runs them in an empty folder."""

from __future__ import annotations

import csv
import os
import re
import subprocess
import sys
from pathlib import Path

from tests.cmake.project import ROOT

PAGE = (ROOT / "docs/systems.md").read_text(encoding="utf-8")
IMAGES = "cmake --build build --target two_jiwys_images"
"""The command that test_images.py runs."""


def block(name: str) -> str:
    """The first block of code after the page's comment ``name``."""
    text = PAGE.partition(f"<!-- {name} -->")[2].partition("<!-- end -->")[0]
    return text.split("```")[1].partition("\n")[2]


def run(folder: Path, command: str) -> str:
    """Runs a command of the page, with the `epg` and the package of this checkout."""
    command = re.sub(r"\bepg (?=new|--)", f"'{sys.executable}' '{ROOT / 'epg'}' ", command)
    command = command.replace("cmake -B", f"cmake -DPython3_EXECUTABLE='{sys.executable}' -DEPG_PATH='{ROOT}' -B")
    environment = {name: value for name, value in os.environ.items() if name not in ("EPG_DIR", "EPG_PATH")}
    environment |= {"CMAKE_GENERATOR": "Ninja", "CMAKE_BUILD_PARALLEL_LEVEL": "2"}
    done = subprocess.run(command, shell=True, cwd=folder, capture_output=True, text=True, env=environment)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


def test_two_jiwys_move_after_four_commands(tmp_path: Path) -> None:
    run(tmp_path, block("files"))
    system = block("two jiwys")
    assert len(system.splitlines()) <= 12
    (tmp_path / "two_jiwys.system.yaml").write_text(system)
    *commands, images = block("commands").splitlines()
    assert images == IMAGES
    output = [run(tmp_path, command) for command in commands][-1]
    assert re.search(r"^follower\s+9000 of 1 ms\s+enabled", output, re.MULTILINE)
    assert (tmp_path / "build/tracking.csv").is_file()
    with (tmp_path / "build/tracking.csv").open(newline="") as file:
        *_, last = csv.DictReader(file)
    ends = {name: float(value) for name, value in last.items() if name.endswith("position")}
    assert len(ends) == 4 and all(abs(value - 0.3) < 0.01 for value in ends.values()), last
    assert "two_jiwys_images" in run(tmp_path, "cmake --build build --target help")
    assert run(tmp_path, "build/two_jiwys --help").startswith("usage: two_jiwys --duration SECONDS")
