# SPDX-License-Identifier: Apache-2.0
"""`epg doctor` and a configure run find the same SDK in the same surroundings."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

import pytest

from epg.generator.bootstrap import cache_folder
from epg.generator.diagnostics import Diagnostics
from epg.generator.tools.find_tool import Finding, Surroundings, find_tool
from epg.generator.tools.remedy import command_for
from epg.generator.tools.tools import load_tools

ROOT = Path(__file__).resolve().parents[2]
FILES = [f"cmake/EPG{name}.cmake" for name in ("Python", "Sdk", "Versions", "Missing", "Fetch")]
THING = {
    "api": 1,
    "tool": "thing",
    "title": "Thing",
    "needed_for": "tests",
    "oldest": "1.2.0",
    "holds": "thing.cmake",
    "variables": ["THING_PATH", "THING_DIR"],
    "environment": ["THING_PATH", "THING_HOME"],
    "places": ["~/.things/*", "~/thing sdk"],
    "registry": "Thing",
    "version": {"file": "version.txt", "patterns": ["version\\s+(\\d+(?:\\.\\d+)+)"]},
    "get": {"any": "get the thing"},
}
COMPILER = {
    **{key: THING[key] for key in ("api", "needed_for", "get")},
    "tool": "arm_gcc",
    "title": "Arm GNU toolchain",
    "programs": ["some-gcc", "some-cc"],
    "places": ["~/compilers/*", "~/more/*"],
}

pytestmark = pytest.mark.skipif(not shutil.which("cmake"), reason="CMake is not installed: sudo apt install cmake")


@dataclass(frozen=True)
class Situation:
    """Folders in the home folder with the version of the Thing in them; variables name folders there, too."""

    things: Mapping[str, str] = field(default_factory=dict)
    environment: Mapping[str, str] = field(default_factory=dict)
    cmake: Mapping[str, str] = field(default_factory=dict)
    registry: tuple[str, ...] = ()
    empty: tuple[str, ...] = ()
    """Empty folders."""


SITUATIONS = {
    "nothing": (Situation(), "missing", ""),
    "variable": (Situation({"a": "1.5", ".things/1": "1.9"}, cmake={"THING_PATH": "a"}), "found", "a"),
    "second variable": (Situation({"a": "1.5", "b": "1.5"}, {"THING_PATH": "b"}, {"THING_DIR": "a"}), "found", "a"),
    "first of two": (Situation({"a": "2.0", "b": "1.5"}, cmake={"THING_DIR": "a", "THING_PATH": "b"}), "found", "b"),
    "variable leads elsewhere": (Situation({".things/1": "1.9"}, cmake={"THING_PATH": "a"}), "wrong", ""),
    "environment": (Situation({"a": "1.5", ".things/1": "1.9"}, {"THING_HOME": "a"}), "found", "a"),
    "environment leads elsewhere": (Situation({".things/1": "1.9"}, {"THING_HOME": "a"}), "wrong", ""),
    "newest": (Situation({".things/1.9": "1.9", ".things/1.10": "1.10"}), "found", ".things/1.10"),
    "newest with a suffix": (
        Situation({".things/2.2.0": "2.2.0", ".things/2.2.0-a4": "2.2.0"}),
        "found",
        ".things/2.2.0-a4",
    ),
    "letters before numbers": (Situation({".things/old-1": "1.5", ".things/2": "2.0"}), "found", ".things/old-1"),
    "underscores": (Situation({".things/14_2_Rel1": "14.2", ".things/9_3_Rel1": "9.3"}), "found", ".things/14_2_Rel1"),
    "order of places": (Situation({".things/1": "1.5", "thing sdk": "9.9"}), "found", ".things/1"),
    "blank in a name": (Situation({"thing sdk": "1.5"}), "found", "thing sdk"),
    "place without the file": (
        Situation({"cache/thing-1": "1.5"}, empty=(".things/9",)),
        "found",
        "cache/thing-1",
    ),
    "registry": (Situation({"r": "1.5", "cache/thing-9": "9.9"}, registry=("r/share/cmake",)), "found", "r"),
    "place before registry": (Situation({"r": "1.9", ".things/1": "1.5"}, registry=("r",)), "found", ".things/1"),
    "registry names nothing": (
        Situation({"cache/thing-1": "1.5"}, registry=("x/y",)),
        "found",
        "cache/thing-1",
    ),
    "two in the registry": (Situation({"r9": "1.5", "r10": "1.5"}, registry=("r9", "r10")), "found", "r10"),
    "cache": (
        Situation({"cache/thing-1.9": "1.9", "cache/thing-1.10": "1.10"}),
        "found",
        "cache/thing-1.10",
    ),
    "old": (Situation({".things/1": "1.1.9"}), "old", ".things/1"),
    "just new enough": (Situation({".things/1": "1.2"}), "found", ".things/1"),
    "no version": (Situation({".things/1": ""}), "found", ".things/1"),
}


def environment_of(home: Path, situation: Situation) -> dict[str, str]:
    """The environment of a computer with only the folders of the situation."""
    for name, version in situation.things.items():
        (home / name).mkdir(parents=True)
        (home / name / "thing.cmake").write_text("")
        (home / name / "version.txt").write_text(f"version {version}\n")
    for name in situation.empty:
        (home / name).mkdir(parents=True)
    for number, name in enumerate(situation.registry):
        entry = home / ".cmake/packages/Thing" / str(number)
        entry.parent.mkdir(parents=True, exist_ok=True)
        entry.write_text(f"{home / name}\n")
    variables = {name: str(home / folder) for name, folder in situation.environment.items()}
    return {"HOME": str(home), "EPG_CACHE": str(home / "cache"), "PATH": os.environ["PATH"], **variables}


def cmake_says(
    call: str, data: Path, environment: Mapping[str, str], cmake: Mapping[str, str], folder: Path
) -> tuple[str, str, str]:
    """Folder, version and problem that a function of EPG's CMake package returns."""
    includes = "".join(f'include("{ROOT.as_posix()}/{name}")\n' for name in FILES)
    script = folder / "find.cmake"
    script.write_text(
        f'{includes}set(EPG_TARGETS_PATH "{data.as_posix()}/targets")\n{call}\n'
        'file(WRITE "${CMAKE_CURRENT_LIST_DIR}/answer" "${found}|${found_VERSION}|${found_PROBLEM}")\n'
    )
    given = [f"-D{name}={value}" for name, value in {"Python3_EXECUTABLE": sys.executable, **cmake}.items()]
    subprocess.run(["cmake", *given, "-P", str(script)], env=environment, check=True, capture_output=True)
    path, version, problem = (folder / "answer").read_text().split("|", 2)
    return path, version, problem


def python_says(tool: str, data: Path, environment: Mapping[str, str], cmake: Mapping[str, str], home: Path) -> Finding:
    tools = load_tools([data / "targets"], Diagnostics())
    return find_tool(tools[tool], Surroundings(environment, cmake, home, home / "cache"))


def table(folder: Path, *tools: Mapping[str, object]) -> Path:
    """A data folder of EPG with these tools."""
    (folder / "targets" / "tools").mkdir(parents=True)
    for tool in tools:
        (folder / "targets" / "tools" / f"{tool['tool']}.json").write_text(json.dumps(tool))
    return folder


@pytest.mark.parametrize("name", SITUATIONS)
def test_both_find_the_same(name: str, tmp_path: Path) -> None:
    situation, status, place = SITUATIONS[name]
    data, home = table(tmp_path / "data", THING), tmp_path / "home"
    home.mkdir()
    environment = environment_of(home, situation)
    cmake = {name: str(home / folder) for name, folder in situation.cmake.items()}
    found = python_says("thing", data, environment, cmake, home)
    assert (found.status, found.path if status in ("found", "old") else None) == (
        status,
        home / place if place else None,
    )
    path, version, problem = cmake_says("_epg_find_sdk(found thing)", data, environment, cmake, tmp_path)
    words = {
        "missing": "was not found",
        "wrong": "does not lead to the Thing",
        "old": "EPG needs 1.2.0 or newer",
        "found": "",
    }
    assert words[status] in problem and bool(problem) == (status != "found")
    if status == "found":
        assert (Path(path), version) == (found.path, found.version)
    if status == "old":
        assert f"in {found.path} is {found.version};" in problem


@pytest.mark.parametrize(
    ("programs", "expected"),
    [
        ({}, ""),
        ({"compilers/9/bin/some-gcc", "compilers/10/bin/some-gcc"}, "compilers/10"),
        ({"compilers/1/some-gcc", "more/1/bin/some-gcc"}, "compilers/1"),
        ({"compilers/1/bin/other", "more/1/bin/some-cc"}, "more/1"),
    ],
)
def test_both_find_the_same_compiler(programs: set[str], expected: str, tmp_path: Path) -> None:
    data, home = table(tmp_path / "data", COMPILER), tmp_path / "home"
    home.mkdir()
    for name in programs:
        (home / name).parent.mkdir(parents=True)
        (home / name).write_text("#!/bin/sh\necho 'gcc 1.2'\n")
        (home / name).chmod(0o755)
    environment = environment_of(home, Situation())
    found = python_says("arm_gcc", data, environment, {}, home)
    assert (found.path is not None and found.path.is_relative_to(home / expected)) == bool(expected)
    path, _, problem = cmake_says("_epg_find_sdk(found arm_gcc)", data, environment, {}, tmp_path)
    assert (path, bool(problem)) == (str(home / expected) if expected else "", not expected)


@pytest.mark.parametrize(
    "tool", [path.stem for path in sorted((ROOT / "targets" / "tools").glob("*.json")) if '"holds"' in path.read_text()]
)
def test_this_computer(tool: str, tmp_path: Path) -> None:
    """With the tools that are installed here."""
    found = find_tool(load_tools([ROOT / "targets"], Diagnostics())[tool], Surroundings.here(cache_folder()))
    call = f"set(FETCHCONTENT_FULLY_DISCONNECTED TRUE)\n_epg_find_sdk(found {tool})"
    path, version, problem = cmake_says(call, ROOT, os.environ, {}, tmp_path)
    assert (bool(problem), path and Path(path)) == (
        found.status != "found",
        found.path if found.status == "found" else "",
    )
    assert found.status != "found" or version == found.version


def test_both_name_the_same_command(tmp_path: Path) -> None:
    """The commands that install missing tools."""
    tools = load_tools([ROOT / "targets"], Diagnostics())
    where = Surroundings.here(cache_folder())
    expected = [f"Get it:\n  {command_for(tool, where, tools)}" for tool in tools.values()]
    call = "".join(f'_epg_find_sdk(tool {name})\nstring(APPEND found "${{tool_REMEDY}}#")\n' for name in tools)
    call = f"set(FETCHCONTENT_FULLY_DISCONNECTED TRUE)\n_epg_search_tools(all {' '.join(tools)})\n{call}"
    assert cmake_says(call, ROOT, os.environ, {}, tmp_path)[0].split("#")[:-1] == expected


def test_one_start_of_python_serves_a_configure_run(tmp_path: Path) -> None:
    """Another search starts only if a variable of the wanted tool has changed."""
    data, home = table(tmp_path / "data", THING), tmp_path / "home"
    home.mkdir()
    environment = environment_of(home, Situation({"a": "1.5", ".things/1": "1.9"}))
    starts = tmp_path / "starts"
    python = tmp_path / "python"
    python.write_text(f'#!/bin/sh\necho "$@" >> {starts}\nexec {sys.executable} "$@"\n')
    python.chmod(0o755)
    steps = ("", "set(PICO_SDK_PATH /x)", f"set(THING_PATH {home}/a)", "")
    call = f"set(EPG_PYTHON {python})\nset(EPG_PYTHON_WANTED ${{Python3_EXECUTABLE}}||)\n"
    for step in steps:
        call += f'{step}\n_epg_find_sdk(thing thing)\nstring(APPEND found "${{thing}} ")\n'
    found = cmake_says(call, data, environment, {}, tmp_path)[0].split()
    assert found == [f"{home}/.things/1"] * 2 + [f"{home}/a"] * 2
    assert len(starts.read_text().splitlines()) == 2
