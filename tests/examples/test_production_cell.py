# SPDX-License-Identifier: Apache-2.0
"""The production cell: no two parts meet and no block is lost, with and without faults; its page and its picture."""

from __future__ import annotations

import importlib.util
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path
from types import ModuleType

import pytest

from tests.cmake.project import ROOT, Project

EXAMPLE = ROOT / "examples/production_cell"
PICTURE = ROOT / "docs/pictures/production-cell.svg"
PAGE = (EXAMPLE / "README.md").read_text(encoding="utf-8")
LEASED = "return heard->state > 0.5 && heard->echo > asked && heard->echo <= now && now - heard->echo < lease;"
FREE = (
    "return !owner->grants && now > end && heard->echo > end && heard->echo <= now && !space_is(heard, SPACE_INSIDE);"
)


def module(name: str) -> ModuleType:
    """A program of the example."""
    spec = importlib.util.spec_from_file_location(name, EXAMPLE / f"{name}.py")
    assert spec is not None and spec.loader is not None
    loaded = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(loaded)
    return loaded


FAULTS, ANIMATION = module("random_faults"), module("animation")


def kept(project: Project, folder: Path) -> Path:
    """A copy of the program of the simulation."""
    folder.mkdir()
    for file in (project.build_folder / "production_cell", *project.build_folder.glob("*.so")):
        shutil.copy(file, folder)
    return folder / "production_cell"


@pytest.fixture(scope="module")
def project(tmp_path_factory: pytest.TempPathFactory) -> Project:
    made = Project(tmp_path_factory.mktemp("cell"), "production_cell")
    shutil.copytree(EXAMPLE, made.source)
    made.configure(f"-DEPG_PATH={ROOT}")
    made.build()
    return made


@pytest.fixture(scope="module")
def program(project: Project) -> Path:
    return kept(project, project.folder / "good")


@pytest.fixture(scope="module")
def mutant(project: Project, program: Path) -> Path:
    """The program without leases: a grant is good until the owner takes it back, and the newest message counts."""
    project.edit("common/space.c", LEASED, "(void)asked, (void)now, (void)lease;\n    return heard->state > 0.5;")
    project.edit(
        "common/space.c", FREE, "(void)now, (void)end;\n    return !owner->grants && !space_is(heard, SPACE_INSIDE);"
    )
    for file in project.source.glob("*.tcf"):
        file.write_text(
            file.read_text(encoding="utf-8").replace(", timeout: 200 ms, on_timeout: zero", ""), encoding="utf-8"
        )
    project.build()
    return kept(project, project.folder / "mutant")


def test_all_targets_pass_the_checks_for_their_boards() -> None:
    command = [sys.executable, "-m", "epg", "check", EXAMPLE / "production_cell.system.yaml"]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert done.stdout.endswith("no errors\n") and "warning" not in done.stderr


def test_the_picture(program: Path, tmp_path: Path) -> None:
    """The picture in the README is a part of the simulation.  EPG_UPDATE_GOLDEN=1 draws it again."""
    subprocess.run([program, "--duration", "50", "--trace", tmp_path], check=True, stdout=subprocess.DEVNULL)
    picture = ANIMATION.picture(tmp_path)
    if os.environ.get("EPG_UPDATE_GOLDEN"):
        PICTURE.write_text(picture, encoding="utf-8")
    assert PICTURE.read_text(encoding="utf-8") == picture
    assert len(picture) < 60_000


def test_an_hour(program: Path) -> None:
    """Its throughput is the one in the README."""
    end = FAULTS.run(program, [], 3600)
    assert (end["collisions"], end["lost"]) == (0, 0)
    stated = re.search(r"(\d+) blocks leave the mould in an hour", PAGE)
    assert stated and end["moulded"] == int(stated.group(1))


def test_the_scenario(project: Project) -> None:
    assert "all 2 limits of the scenario hold" in project.build("--target", "killed")


@pytest.mark.parametrize("machine", FAULTS.MACHINES)
def test_a_machine_is_killed_and_restarted(program: Path, machine: str) -> None:
    """Without it, the line stops within a round or two; when it is back, the blocks go round again."""
    dead = FAULTS.run(program, [(31, machine, "die")], 90)
    back = FAULTS.run(program, [(31, machine, "die"), (50, machine, "restart")], 90)
    for end in (dead, back):
        assert (end["collisions"], end["lost"]) == (0, 0)
    assert dead["last_moulded"] < 31 + 20
    assert back["last_moulded"] > 80
    assert back["moulded"] >= dead["moulded"] + 3


def test_random_faults(program: Path) -> None:
    assert {text for text in FAULTS.verdicts(program, range(200)).values() if text} == set()


def test_a_mutant_without_leases_is_caught(mutant: Path) -> None:
    found = FAULTS.verdicts(mutant, range(60)).values()
    assert any("two parts in one space" in text for text in found)


def test_ten_thousand_runs_with_random_faults(program: Path) -> None:
    assert {text for text in FAULTS.verdicts(program, range(10_000)).values() if text} == set()
