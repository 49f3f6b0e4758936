# SPDX-License-Identifier: Apache-2.0
"""FMUs in epg_add_model and epg_add_target."""

from __future__ import annotations

import os
import re
import subprocess
from pathlib import Path

import pytest

from tests.cmake.project import ROOT, Project, compiled, snapshot
from tests.models.fmus import FMU2, changed, pack

ARCHIVE = "model of pan/servo.fmu"


def project(folder: Path) -> Project:
    made = Project(folder, "fmus")
    pack(FMU2, made.source / ARCHIVE)
    no_mode = ('name="mode" valueReference="0" causality="input"', 'name="mode" valueReference="0" causality="local"')
    fmu = changed(FMU2, folder / "no_mode", "modelDescription.xml", no_mode)
    pack(fmu, made.source / "controller/servo.fmu")
    return made


@pytest.fixture(scope="module")
def built(tmp_path_factory: pytest.TempPathFactory) -> Project:
    made = project(tmp_path_factory.mktemp("fmus"))
    made.configure(f"-DFMUS={ROOT / 'tests/models'}")
    before = snapshot(made.source)
    made.build()
    assert snapshot(made.source) == before
    return made


def test_side_by_side(built: Project) -> None:
    done = subprocess.run([built.build_folder / "together"], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert done.stdout.splitlines() == ["1 0 100 100", "1 1 1"]


def test_in_a_target(built: Project) -> None:
    """The period is the step of the FMU."""
    command = [built.build_folder / "servo_host", "--duration", "0.2"]
    done = subprocess.run(command, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert "200" in done.stdout


def test_the_console_offers_what_can_be_changed(built: Project) -> None:
    """A fixed parameter cannot be changed after the start."""
    table = (built.build_folder / "epg/servo/servo_app.c").read_text().partition("parameter_table[] = {")[2]
    names = re.findall(r'\.name = "([^"]+)"', table.partition("};")[0])
    assert names == ["PI.kp", "PI.ki"]


def test_a_changed_archive_is_unpacked_and_compiled_again(built: Project, tmp_path: Path) -> None:
    """Only files that have changed in the archive are compiled; without a change, no file is."""
    assert compiled(built.build()) == set()
    fmu = changed(FMU2, tmp_path / "fmu", "sources/law.c", ("limit(duty);", "limit(0.5 * duty);"))
    path = pack(fmu, built.source / ARCHIVE)
    later = path.stat().st_mtime + 2
    os.utime(path, (later, later))
    assert {"law.c"} <= compiled(built.build()) <= {"law.c", "servo_version.c", "servo_app.c"}
    done = subprocess.run([built.build_folder / "together"], capture_output=True, text=True, check=True)
    assert done.stdout.splitlines()[0] == "0 0 100 100"
