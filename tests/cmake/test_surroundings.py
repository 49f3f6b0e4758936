# SPDX-License-Identifier: Apache-2.0
"""EPG's output depends only on the files that it reads, and not on the environment."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

import pytest

from tests.cmake.project import ROOT

#: Beginnings of variables that could change the output: no case has them unless it sets them.
SET_BY_CASES = ("LC_", "LANG", "TZ", "PYTHONHASHSEED", "PYTHONUTF8", "PYTHONIOENCODING", "EPG_", "COLUMNS", "NO_COLOR")


@dataclass(frozen=True)
class Surroundings:
    name: str
    variables: Mapping[str, str] = field(default_factory=dict)
    folder: str = "project"
    epg: str = "epg"
    umask: int = 0o022
    locale: str = ""  #: must be installed for this case
    arguments: tuple[str, ...] = ()


USUAL = Surroundings("usual", {"PYTHONHASHSEED": "1", "LC_ALL": "C.UTF-8", "TZ": "UTC"})
ALL = {
    "PYTHONHASHSEED": "random", "TZ": "Asia/Kathmandu", "HOME": "/nonexistent", "XDG_CACHE_HOME": "",
    "COLUMNS": "20", "NO_COLOR": "1", "TERM": "dumb",
}  # fmt: skip
ALL_FOLDERS = {"folder": "a folder with blanks/für/mich", "epg": "some where/else"}
OTHERS = (
    Surroundings("another folder", folder="a folder with blanks/and ümlauts/project"),
    Surroundings("another folder of EPG", epg="some where/else"),
    Surroundings("another hash seed", {"PYTHONHASHSEED": "4294967295"}),
    Surroundings("random hashes", {"PYTHONHASHSEED": "random"}),
    Surroundings("the locale C", {"LC_ALL": "C", "PYTHONUTF8": "0"}),
    Surroundings("a folder that the locale cannot write", {"LC_ALL": "C", "PYTHONUTF8": "0"}, folder="für/mich"),
    Surroundings("Turkish, whose i has a dot as capital", {"LC_ALL": "tr_TR.UTF-8"}, locale="tr_TR.utf8"),
    Surroundings("German, with decimal commas", {"LC_ALL": "de_DE.UTF-8"}, locale="de_DE.utf8"),
    Surroundings("another time zone", {"TZ": "Asia/Kathmandu"}),
    Surroundings("a strict umask", umask=0o077),
    Surroundings("another home", {"HOME": "/nonexistent", "XDG_CACHE_HOME": ""}),
    Surroundings("another terminal", {"COLUMNS": "20", "NO_COLOR": "1", "TERM": "dumb"}),
    Surroundings("a release build with Makefiles", arguments=("-G", "Unix Makefiles", "-DCMAKE_BUILD_TYPE=Release")),
    Surroundings("all at once", {**ALL, "LC_ALL": "C", "PYTHONUTF8": "0"}, **ALL_FOLDERS, umask=0o077),
    Surroundings(
        "all at once in Turkish", {**ALL, "LC_ALL": "tr_TR.UTF-8"}, **ALL_FOLDERS, umask=0o077, locale="tr_TR.utf8",
        arguments=("-G", "Unix Makefiles", "-DCMAKE_BUILD_TYPE=Release"),
    ),
)  # fmt: skip
"""`check_all` has the last two.  They differ from the usual surroundings in all that the others differ in singly."""

CMAKELISTS = """cmake_minimum_required(VERSION 3.22...3.31)
project(surroundings LANGUAGES C CXX)
find_package(EPG REQUIRED)
add_subdirectory(robot)
add_subdirectory(jiwy)
epg_add_model(wheels MODEL relbot/model INSTANCES 2)
epg_add_model(tokens_only MODEL tokens)
"""


def generated(around: Surroundings, folder: Path) -> dict[str, bytes]:
    """Every file in ``<build>/epg`` after configuring a project with two targets and two models."""
    epg, project = folder / around.epg, folder / around.folder
    for tree in ("cmake", "epg", "schemas", "targets", "docs"):
        shutil.copytree(ROOT / tree, epg / tree, ignore=shutil.ignore_patterns("__pycache__"))
    for example in ("jiwy", "relbot"):
        shutil.copytree(ROOT / "examples" / example, project / example, ignore=shutil.ignore_patterns("build"))
    shutil.copytree(ROOT / "tests/cmake/projects/robot", project / "robot")
    (project / "tokens").mkdir()
    shutil.copy(ROOT / "examples/jiwy/model/tokens.xml", project / "tokens")
    (project / "CMakeLists.txt").write_text(CMAKELISTS)

    environment = {key: value for key, value in os.environ.items() if not key.startswith(SET_BY_CASES)}
    if "EPG_CACHE" in os.environ:
        environment["EPG_CACHE"] = os.environ["EPG_CACHE"]
    done = subprocess.run(
        [
            *("cmake", "-S", project, "-B", project / "build", f"-DEPG_DIR={epg / 'cmake'}", f"-DEPG_PATH={epg}"),
            f"-DPython3_EXECUTABLE={sys.executable}",
            *(around.arguments or ("-G", "Ninja")),
        ],
        env={**environment, **around.variables},
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        preexec_fn=lambda: os.umask(around.umask) and None,
    )
    assert done.returncode == 0, done.stdout.decode(errors="replace")
    root = project / "build" / "epg"
    return {str(path.relative_to(root)): path.read_bytes() for path in sorted(root.rglob("*")) if path.is_file()}


@pytest.fixture(scope="module")
def usual(tmp_path_factory: pytest.TempPathFactory) -> dict[str, bytes]:
    files = generated(USUAL, tmp_path_factory.mktemp("usual"))
    assert {"robot/robot_app.c", "jiwy/jiwy_app.c", "jiwy/jiwy.json", "wheels/wheels.h"} <= set(files)
    return files


@pytest.mark.parametrize("around", OTHERS, ids=lambda around: around.name.replace(" ", "-"))
def test_output_is_the_same(around: Surroundings, usual: dict[str, bytes], tmp_path: Path) -> None:
    if around.locale:
        installed = subprocess.run(["locale", "-a"], capture_output=True, text=True).stdout.split()
        if around.locale not in installed:
            pytest.skip(f"the locale {around.locale} is not installed")
    files = generated(around, tmp_path)
    assert set(files) == set(usual)
    for name, content in files.items():
        assert content == usual[name], f"{name} differs"
