# SPDX-License-Identifier: Apache-2.0
"""The search for SDKs and programs: the order of places, and the table of tools."""

from __future__ import annotations

import json
import os
import re
import shutil
import sys
from dataclasses import replace
from fnmatch import fnmatch
from pathlib import Path

import jsonschema
import pytest

from epg.generator import install
from epg.generator.diagnostics import Diagnostics
from epg.generator.tools import find_tool as module
from epg.generator.tools import remedy
from epg.generator.tools.find_tool import Surroundings, find_tool, read_cmake_cache
from epg.generator.tools.tools import Tool, load_tools

ROOT = Path(__file__).resolve().parent.parent.parent
TABLE = load_tools([ROOT / "targets"], Diagnostics())

SDK = Tool(
    name="my_sdk",
    title="My SDK",
    needed_for="something",
    holds="sdk.cmake",
    variables=("MY_SDK_PATH",),
    environment=("MY_SDK_PATH",),
    places=("~/.my/sdk/*",),
    registry="MySdk",
    cached="my_sdk-*",
    oldest="1.2",
    version_file="version.txt",
    version_patterns=(r"major (\d+)", r"minor (\d+)"),
)
PROGRAM = Tool(
    name="mycc", title="My compiler", needed_for="something", programs=("mycc", "othercc"), environment=("MYCC",)
)


@pytest.fixture
def where(tmp_path: Path) -> Surroundings:
    """A computer without any tool."""
    for name in ("home", "cache", "bin"):
        (tmp_path / name).mkdir()
    return Surroundings({"PATH": str(tmp_path / "bin")}, {}, tmp_path / "home", tmp_path / "cache")


def sdk(folder: Path, version: str = "1.5") -> Path:
    folder.mkdir(parents=True)
    (folder / "sdk.cmake").write_text("")
    major, minor = version.split(".")
    (folder / "version.txt").write_text(f"major {major}\nminor {minor}\n")
    return folder


def program(file: Path, says: str = "mycc (Company 9.9) 3.4.5", then: str = "") -> Path:
    file.parent.mkdir(parents=True, exist_ok=True)
    file.write_text(f"#!/bin/sh\necho '{says}'\n{then}\n")
    file.chmod(0o755)
    return file


def test_the_order_of_places(where: Surroundings, tmp_path: Path) -> None:
    """Each place has priority over all later ones."""
    places = [("EPG's cache", where, sdk(where.cache / "my_sdk-1.5"))]
    entry = where.home / ".cmake/packages/MySdk/0123abcd"
    entry.parent.mkdir(parents=True)
    registered = sdk(tmp_path / "registered")
    entry.write_text(f"{registered}/share/package/cmake\n")
    places.append(("CMake's package registry (MySdk)", where, registered))
    assert find_tool(SDK, where).path == registered
    sdk(where.home / ".my/sdk/1.9")
    places.append(("~/.my/sdk/*", where, sdk(where.home / ".my/sdk/1.10")))
    environment = sdk(tmp_path / "environment")
    stated = replace(where, environment={**where.environment, "MY_SDK_PATH": str(environment)})
    places.append(("environment variable MY_SDK_PATH", stated, environment))
    variable = sdk(tmp_path / "variable")
    places.append(("CMake variable MY_SDK_PATH", replace(stated, cmake={"MY_SDK_PATH": str(variable)}), variable))
    for source, surroundings, expected in places[2:]:
        finding = find_tool(SDK, surroundings)
        assert (finding.status, finding.source, finding.path) == ("found", source, expected)
    assert find_tool(replace(SDK, places=()), where).source == places[1][0]
    assert find_tool(replace(SDK, places=(), registry="Other"), where).source == places[0][0]


def test_what_is_missing_says_where_it_was_looked_for(where: Surroundings) -> None:
    finding = find_tool(SDK, where)
    assert finding.status == "missing"
    assert finding.looked == ("~/.my/sdk/*", "CMake's package registry (MySdk)", "EPG's cache")


def test_versions(where: Surroundings) -> None:
    sdk(where.cache / "my_sdk-1", "1.1")
    assert (find_tool(SDK, where).status, find_tool(SDK, where).version) == ("old", "1.1")
    sdk(where.cache / "my_sdk-2", "1.2")
    assert (find_tool(SDK, where).status, find_tool(SDK, where).version) == ("found", "1.2")
    (where.cache / "my_sdk-2/version.txt").write_text("major 1\n")
    assert (find_tool(SDK, where).status, find_tool(SDK, where).version) == ("found", "")


def test_a_variable_that_leads_elsewhere_is_not_passed_over(where: Surroundings, tmp_path: Path) -> None:
    sdk(where.cache / "my_sdk-1.5")
    finding = find_tool(SDK, replace(where, environment={"MY_SDK_PATH": str(tmp_path)}))
    assert (finding.status, finding.path, finding.source) == (
        "wrong",
        tmp_path,
        "environment variable MY_SDK_PATH",
    )


def test_programs(where: Surroundings, tmp_path: Path) -> None:
    assert find_tool(PROGRAM, where).status == "missing"
    other = program(tmp_path / "bin/othercc", "othercc 1.2")
    finding = find_tool(PROGRAM, where)
    assert (finding.path, finding.version, finding.source) == (other, "1.2", "PATH")
    first = program(tmp_path / "bin/mycc")
    assert find_tool(PROGRAM, where).path == first
    patterns = (r"\) (\d+(?:\.\d+)+)",)
    assert find_tool(replace(PROGRAM, version_patterns=patterns), where).version == "3.4.5"


@pytest.mark.parametrize("value", ["{folder}", "{folder}/bin", "{folder}/bin/mycc", "{folder}/bin/mycc -m32", "mycc"])
def test_a_variable_names_a_program_in_any_way(value: str, where: Surroundings, tmp_path: Path) -> None:
    expected = program(tmp_path / "toolchain/bin/mycc")
    environment = {"MYCC": value.format(folder=tmp_path / "toolchain"), "PATH": str(expected.parent)}
    assert find_tool(PROGRAM, replace(where, environment=environment)).path == expected


def test_a_folder_called_as_the_program_is_not_searched(
    where: Surroundings, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    program(tmp_path / "project/mycc/mycc")
    monkeypatch.chdir(tmp_path / "project")
    assert find_tool(PROGRAM, where).status == "missing"


def test_a_program_that_hangs_has_no_version(
    where: Surroundings, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(module, "TIMEOUT", 0.2)
    program(tmp_path / "bin/mycc", then="exec /bin/sleep 30")
    finding = find_tool(PROGRAM, where)
    assert (finding.status, finding.version) == ("found", "")


def test_a_cmake_cache(tmp_path: Path) -> None:
    file = tmp_path / "CMakeCache.txt"
    file.write_text(
        "# a comment\n//Path\nPICO_SDK_PATH:PATH=/opt/sdk\nA:UNINITIALIZED=x=y\nB:FILEPATH=B-NOTFOUND\nC:BOOL=\n"
    )
    assert read_cmake_cache(file, Diagnostics()) == {"PICO_SDK_PATH": "/opt/sdk", "A": "x=y"}
    file.write_bytes(file.read_bytes().replace(b"\n", b"\r\n"))  # as CMake writes it on Windows
    assert read_cmake_cache(file, Diagnostics()) == {"PICO_SDK_PATH": "/opt/sdk", "A": "x=y"}
    diagnostics = Diagnostics()
    read_cmake_cache(tmp_path / "nothing", diagnostics)
    assert [item.id for item in diagnostics] == ["file-not-found"]


def test_the_table_is_right() -> None:
    schema = json.loads((ROOT / "schemas/tool.schema.json").read_text(encoding="utf-8"))
    files = sorted((ROOT / "targets/tools").glob("*.json"))
    assert [path.stem for path in files] == list(TABLE)
    for path in files:
        jsonschema.Draft202012Validator(schema).validate(json.loads(path.read_text(encoding="utf-8")))
    needed = {"cmake", "c_compiler", "arm_gcc", "pico_sdk", "picotool", "freertos_kernel", "zephyr", "west"}
    assert needed | {"micro_cdr", "micro_xrce_dds_client", "build_program", "zephyr_sdk"} <= set(TABLE)


def test_the_environment_variables_are_by_default_those_of_cmake() -> None:
    assert TABLE["pico_sdk"].environment == TABLE["pico_sdk"].variables == ("PICO_SDK_PATH",)
    assert TABLE["c_compiler"].environment == ("CC",)
    assert TABLE["cmake"].environment == ()


CACHED = [tool for tool in TABLE.values() if "{cache}" in tool.get["any"]]


@pytest.mark.parametrize("tool", CACHED, ids=lambda tool: tool.name)
def test_what_the_command_gets_is_found(tool: Tool, where: Surroundings) -> None:
    """The lookup finds the folder that the table's ``git clone`` makes in EPG's cache."""
    names = set(re.findall(r"\{cache\}/([^\s/]+)", tool.get["any"]))
    (name,) = [name for name in names if fnmatch(name, tool.cached.partition("/")[0]) and tool.tested in name]
    folder = where.cache / name
    found = folder / tool.cached.partition("/")[2]
    (found / tool.holds).parent.mkdir(parents=True)
    (found / tool.holds).write_text("")
    assert find_tool(replace(tool, places=()), where).path == found


@pytest.mark.parametrize("tool", TABLE.values(), ids=lambda tool: tool.name)
def test_commands_of_windows(tool: Tool, where: Surroundings, monkeypatch: pytest.MonkeyPatch) -> None:
    """They need nothing that PowerShell 5.1 or cmd lacks, and no program of another system."""
    monkeypatch.setattr(remedy, "system", lambda: "windows")
    text = remedy.get_it(tool, where, TABLE)
    assert text.startswith("Get it:\n  ")
    wrong = r"&&|~|\{|\$|\b(sudo|apt|apt-get|brew|python3|source|bin/activate|VisualStudio)\b"
    assert not re.search(wrong, text), text


def test_windows_has_a_line_for_each_program(where: Surroundings, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(remedy, "system", lambda: "windows")
    home = replace(where, home=Path("C:/Users/Jörg Groß"))
    assert remedy.command_for(TABLE["zephyr"], home, TABLE).splitlines() == [
        'west init -m https://github.com/zephyrproject-rtos/zephyr --mr v4.1.0 "C:/Users/Jörg Groß"/zephyrproject',
        'cd "C:/Users/Jörg Groß"/zephyrproject',
        "west update",
    ]


@pytest.mark.parametrize("system", ["linux", "macos", "windows"])
def test_each_system_has_a_remedy_of_its_own(system: str, where: Surroundings, monkeypatch: pytest.MonkeyPatch) -> None:
    """Only Linux has apt, sudo and groups of devices, only Windows has py and drivers that the user installs."""
    monkeypatch.setattr(install, "system", lambda: system)
    monkeypatch.setattr(shutil, "which", lambda name: f"/usr/bin/{name}")
    texts = [install.remedy(purpose, folder="epg", tool="picotool", length="300") for purpose in install.REMEDIES]
    texts += install.package_commands(["PyYAML"])
    found = {word for word in ("apt", "sudo", "plugdev", "dialout", "py -m", "Zadig") if any(word in t for t in texts)}
    wanted = {"linux": {"apt", "sudo", "plugdev", "dialout"}, "macos": set(), "windows": {"py -m", "Zadig"}}
    assert found == wanted[system]
    assert f"{sys.executable} -m pip install PyYAML" in texts[-2:]


VERSIONS = {
    "pico_sdk": (
        "pico_sdk_version.cmake",
        "# PICO_BUILD_DEFINE: PICO_SDK_VERSION_MAJOR, SDK major version number, type=int\n"
        "set(PICO_SDK_VERSION_MAJOR 2)\nset(PICO_SDK_VERSION_MINOR 2)\nset(PICO_SDK_VERSION_REVISION 0)\n",
        "2.2.0",
    ),
    "freertos_kernel": ("include/task.h", '#define tskKERNEL_VERSION_NUMBER       "V11.3.0"\n', "11.3.0"),
    "picotool": ("picotoolConfigVersion.cmake", 'set(PACKAGE_VERSION "2.2.0")\n', "2.2.0"),
    "micro_cdr": ("CMakeLists.txt", 'project(microcdr VERSION "2.0.1" LANGUAGES C)\n', "2.0.1"),
    "micro_xrce_dds_client": ("CMakeLists.txt", 'project(microxrcedds_client VERSION "2.4.3" LANGUAGES C)\n', "2.4.3"),
    "zephyr": ("VERSION", "VERSION_MAJOR = 4\nVERSION_MINOR = 1\nPATCHLEVEL = 0\nVERSION_TWEAK = 0\n", "4.1.0"),
    "zephyr_sdk": ("sdk_version", "0.17.0\n", "0.17.0"),
}


@pytest.mark.parametrize("name", VERSIONS)
def test_versions_of_sdks(name: str, where: Surroundings) -> None:
    """The version files of these SDKs, reduced to the relevant lines."""
    file, text, version = VERSIONS[name]
    tool = replace(TABLE[name], places=(), environment=("HERE",))
    folder = where.cache / "here"
    for path, content in ((tool.holds, ""), (file, text)):
        (folder / path).parent.mkdir(parents=True, exist_ok=True)
        (folder / path).write_text(content)
    finding = find_tool(tool, replace(where, environment={"HERE": str(folder)}))
    assert (finding.status, finding.version) == ("found", version)


def test_a_user_s_table_comes_first(tmp_path: Path) -> None:
    (tmp_path / "tools").mkdir()
    data = json.loads((ROOT / "targets/tools/pico_sdk.json").read_text(encoding="utf-8"))
    (tmp_path / "tools/pico_sdk.json").write_text(json.dumps({**data, "title": "mine"}))
    assert load_tools([tmp_path, ROOT / "targets"], Diagnostics())["pico_sdk"].title == "mine"


@pytest.mark.parametrize(
    ("text", "line", "message"),
    [
        ('{"api": 1,\n "tool" "x"}', 2, "this is not JSON"),
        ("[]", 1, "this does not describe a tool"),
        ('{"api": 1}', 1, "this does not describe a tool"),
        ('{"api": 2, "tool": "x", "title": "x", "needed_for": "x", "programs": ["x"], "get": {}}', 1, "not describe"),
        ('{"api": 1, "tool": "x", "title": 3, "needed_for": "x", "programs": ["x"], "get": {}}', 1, "not describe"),
        ('{"api": 1, "tool": "x", "title": "x", "needed_for": "x", "programs": "x", "get": {}}', 1, "not describe"),
        (
            '{"api": 1, "tool": "x", "title": "x", "needed_for": "x", "holds": "x", "get": {},'
            ' "version": {"patterns": ["("]}}',
            1,
            "not describe",
        ),
    ],
)
def test_wrong_tables(tmp_path: Path, text: str, line: int, message: str) -> None:
    (tmp_path / "tools").mkdir()
    (tmp_path / "tools/x.json").write_text(text)
    diagnostics = Diagnostics()
    assert load_tools([tmp_path], diagnostics) == {}
    (problem,) = diagnostics
    assert (problem.id, problem.span.line) == ("wrong-value", line)
    assert message in problem.message


def test_this_computer(where: Surroundings) -> None:
    """The compiler that the tests of generated code use."""
    finding = find_tool(TABLE["c_compiler"], replace(where, environment={"PATH": os.environ["PATH"]}))
    assert finding.status == "found"
    assert finding.version
