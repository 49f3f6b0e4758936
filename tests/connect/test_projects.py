# SPDX-License-Identifier: Apache-2.0
"""The targets that `epg connect` finds in a project, without CMake being run."""

from __future__ import annotations

import json
import shutil
import subprocess
import time
from pathlib import Path

import pytest

from epg.connect.cmake.syntax import NotCMake, parse_cmake
from epg.connect.projects import Job, find_jobs, jobs_of_model
from epg.diagnostics import Diagnostics
from epg.project import load_application

ROOT = Path(__file__).resolve().parents[2]
EXAMPLES = ROOT / "examples"
CALL = "epg_add_target(servo TCF servo.tcf MODEL model BINDINGS servo.bindings.yaml)\n"


def project(folder: Path, text: str) -> Path:
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "CMakeLists.txt").write_text(text, encoding="utf-8")
    return folder


def found(folder: Path) -> tuple[list[Job], list[str]]:
    """The jobs, and the places of what is not understood."""
    diagnostics = Diagnostics()
    jobs = find_jobs(folder, diagnostics)
    return jobs, [f"{d.severity} {d.span.line}:{d.span.column} {d.id}" for d in diagnostics]


def configured(folder: Path, source: Path, **variables: str) -> Path:
    """A build folder as CMake leaves it."""
    folder.mkdir(parents=True)
    lines = [f"CMAKE_HOME_DIRECTORY:INTERNAL={source}", *(f"{name}:STRING={v}" for name, v in variables.items())]
    (folder / "CMakeCache.txt").write_text("\n".join(lines) + "\n")
    return folder


EXPECTED = {
    "existing_firmware": (["turntable"], "cmake", "build/host"),
    "existing_firmware/station": (["turntable"], "cmake", "../build/host"),
    "existing_pico_repository": (["turntable"], "cmake", "build"),
    "existing_zephyr_application": (["turntable"], "west", "build"),
    "jiwy": (["jiwy"], "cmake", "build"),
    "ping_pong": ([f"ping_pong_{a}_{b}" for a in ("default", "best") for b in ("default", "best")], "cmake", "build"),
    "relbot": (["relbot"], "cmake", "build"),
    "zephyr_jiwy/app": (["jiwy"], "west", "build"),
    "zephyr_two_boards": (["axis"], "west", "build"),
    "zephyr_two_boards/tilt": (["axis"], "west", "build"),
}


@pytest.fixture(scope="module")
def examples(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A copy, in which nobody has built anything."""
    folder = tmp_path_factory.mktemp("repository") / "examples"
    shutil.copytree(EXAMPLES, folder, ignore=shutil.ignore_patterns("build*"))
    return folder


def test_every_example_with_a_target_is_expected() -> None:
    files = [path for path in EXAMPLES.rglob("CMakeLists.txt") if "build" not in path.parts]
    calling = {str(path.parent.relative_to(EXAMPLES)) for path in files if "\nepg_add_target(" in path.read_text()}
    assert calling - {"existing_pico_repository/turntable"} <= set(EXPECTED)


@pytest.mark.parametrize("example", EXPECTED)
def test_examples_are_found_and_can_be_loaded(example: str, examples: Path) -> None:
    names, built_by, build = EXPECTED[example]
    jobs, _ = found(examples / example)
    assert [job.request.name for job in jobs] == names
    for job in jobs:
        assert job.built_by == built_by
        assert job.build_dir is not None and job.build_dir == (examples / example / build).resolve()
        diagnostics = Diagnostics()
        assert load_application(job.request, diagnostics) is not None, diagnostics.items
        assert job.request.caller is not None and job.request.caller.line > 0


def test_only_what_the_board_decides_is_left_to_cmake(examples: Path) -> None:
    for example in EXPECTED:
        assert found(examples / example)[1] == (
            ["warning 12:27 cmake-not-understood"] if example == "zephyr_jiwy/app" else []
        )


def test_a_build_folder_says_what_variables_are(examples: Path, tmp_path: Path) -> None:
    app = tmp_path / "app"
    shutil.copytree(examples / "zephyr_jiwy" / "app", app)
    build = configured(app / "build", app, BOARD="rpi_pico2/rp2350a/m33")
    jobs, unknown = found(app)
    assert not unknown
    assert [(job.request.tcf, job.board) for job in jobs] == [("rpi_pico2_zephyr_jiwy.tcf", "rpi_pico2/rp2350a/m33")]
    assert jobs[0].build_dir == build


def test_an_image_of_sysbuild_is_built_with_the_others(tmp_path: Path) -> None:
    app = project(tmp_path / "pan", f"{CALL}find_package(Zephyr REQUIRED)\nproject(pan)\n")
    configured(tmp_path / "pan" / "build", Path("/zephyr/share/sysbuild"), APP_DIR=str(app))
    configured(tmp_path / "pan" / "build" / "pan", app, BOARD="rpi_pico")
    ((job,), _) = found(app)
    assert (job.build_dir, job.board, job.built_by) == (app / "build", "rpi_pico", "west")
    tilt = project(app / "tilt", f"{CALL}find_package(Zephyr REQUIRED)\nproject(tilt)\n")
    configured(app / "build" / "tilt", tilt, BOARD="nucleo_h743zi")
    ((job,), _) = found(tilt)
    assert (job.build_dir, job.board) == (app / "build", "nucleo_h743zi")


def test_ping_pong_on_a_board(examples: Path, tmp_path: Path) -> None:
    folder = tmp_path / "ping_pong"
    shutil.copytree(examples / "ping_pong", folder)
    configured(folder / "build" / "pico", folder, PING_PONG_TARGET="rpi_pico2_freertos")
    jobs, unknown = found(folder)
    assert not unknown and len(jobs) == 4
    assert [text for text, _ in jobs[0].request.settings][:2] == [
        "target=rpi_pico2_freertos",
        "communication.middleware=xrce",
    ]
    assert jobs[0].build_dir == folder / "build" / "pico"
    assert jobs[0].executables == ("ping_pong_default_default_rpi_pico2_freertos",)


def test_the_build_folder_that_has_the_target_is_taken(tmp_path: Path) -> None:
    top = project(
        tmp_path, f'project(p C)\nset(KIND host CACHE STRING "")\nif(KIND STREQUAL "host")\n  {CALL}endif()\n'
    )
    configured(top / "build" / "board", top, KIND="board")
    configured(top / "build" / "other", tmp_path / "somewhere")
    right = configured(top / "build" / "with_target", top, KIND="host")
    ((job,), _) = found(top)
    assert job.build_dir == right


def test_a_real_build_folder(tmp_path: Path) -> None:
    """The one CMake makes: its name, and the variable somebody has given."""
    top = project(
        tmp_path / "a b",
        "cmake_minimum_required(VERSION 3.22)\nproject(p NONE)\nfunction(epg_add_target)\nendfunction()\n"
        'set(ROBOT one CACHE STRING "")\nepg_add_target(servo TCF ${ROBOT}.tcf MODEL m BINDINGS b.yaml)\n',
    )
    command = ["cmake", "-S", str(top), "-B", str(top / "cmake-build-debug"), "-DROBOT=two"]
    subprocess.run(command, check=True, capture_output=True)
    ((job,), _) = found(top)
    assert (job.request.tcf, job.build_dir) == ("two.tcf", top / "cmake-build-debug")


def test_presets(tmp_path: Path) -> None:
    top = project(tmp_path, "project(p C)\nepg_add_target(servo TCF ${ROBOT}.tcf MODEL m BINDINGS b.yaml)\n")
    presets = [
        {"name": "base", "hidden": True, "binaryDir": "${sourceDir}/out/${presetName}"},
        {"name": "x", "inherits": "base", "cacheVariables": {"ROBOT": {"type": "STRING", "value": "jiwy"}, "A": True}},
        {"name": "y", "inherits": ["base"], "binaryDir": "${sourceDir}/other"},
    ]
    (top / "CMakePresets.json").write_text(json.dumps({"version": 3, "configurePresets": presets}))
    ((job,), _) = found(top)
    assert (job.request.tcf, job.preset, job.build_dir) == ("jiwy.tcf", "x", top / "out" / "x")
    built = configured(top / "other", top, ROBOT="servo")
    ((job,), _) = found(top)
    assert (job.request.tcf, job.preset, job.build_dir) == ("servo.tcf", "y", built)


@pytest.mark.parametrize(
    "name", ["a" * 5000, "a/" * 3000, "\0", "${sourceDir}/" + "b" * 300], ids=["long", "deep", "nul", "b"]
)
def test_a_build_folder_that_no_system_can_have(name: str, tmp_path: Path) -> None:
    """CMake says what is wrong with it, when it is asked to configure."""
    top = project(tmp_path, "project(p C)\nepg_add_target(servo TCF t.tcf MODEL m BINDINGS b.yaml)\n")
    presets = [{"name": "x", "binaryDir": name}]
    (top / "CMakePresets.json").write_text(json.dumps({"version": 3, "configurePresets": presets}))
    ((job,), _) = found(top)
    assert (job.request.tcf, job.preset) == ("t.tcf", "x")


def test_all_that_a_call_can_say(tmp_path: Path) -> None:
    folder = project(
        tmp_path,
        "project(p C)\n#[[ epg_add_target(not_this TCF a MODEL b BINDINGS c) ]]\n"
        'set(EPG_TARGETS_PATH "my targets;/other")\nset(models ${CMAKE_CURRENT_LIST_DIR}/models)\n'
        'EPG_Add_Target(servo # comment ")\n  BINDINGS [=[b [1].yaml]=] TCF "a \\"b\\".tcf" MODEL ${models}/../m\n'
        "  PLANT ${PROJECT_SOURCE_DIR}/p PLANT_BINDINGS p.yaml NODE n\n"
        "  SET control.period=2\\ ms node=x NAMESPACE /a)\n",
    )
    ((job,), unknown) = found(folder)
    assert not unknown
    request = job.request
    assert (request.name, request.tcf, request.bindings.name) == ("servo", 'a "b".tcf', "b [1].yaml")
    assert (request.model, request.plant, request.plant_bindings) == (folder / "m", folder / "p", folder / "p.yaml")
    assert [text for text, _ in request.settings] == ["control.period=2 ms", "node=x", "node=n", "namespace=/a"]
    assert request.user_roots == (folder / "my targets", Path("/other"))
    span = request.settings[0][1]
    assert (span.line, span.column) == (8, 7)


@pytest.mark.parametrize(
    ("text", "place"),
    [
        ("include(robots.cmake)\nepg_add_target(a TCF ${robot}.tcf MODEL m BINDINGS b)\n", "2:22"),
        ("epg_add_target(${ARGN})\n", "1:16"),
        ("epg_add_target(a TCF x.tcf MODEL m)\n", "1:1"),
        ("epg_add_target()\n", "1:1"),
        ("function(robot name)\n  epg_add_target(${name} TCF x MODEL m BINDINGS b)\nendfunction()\n", "2:3"),
        ("if(X)\nset(t a)\nelse()\nset(t b)\nendif()\nepg_add_target(a TCF ${t} MODEL m BINDINGS b)\n", "6:22"),
        ("file(GLOB t *.tcf)\nepg_add_target(a TCF ${t} MODEL m BINDINGS b)\n", "2:22"),
        ("set(t x)\nlist(APPEND t y)\nepg_add_target(a TCF ${t} MODEL m BINDINGS b)\n", "3:22"),
        ("add_subdirectory(${ROBOT})\n", "1:18"),
        ("if(A)\nepg_add_target(a TCF t MODEL m BINDINGS b)\n", "1:1"),
        ('epg_add_target(a TCF "t)\n', "1:22"),
        ("epg_add_target(a\n", "1:15"),
    ],
)
def test_what_only_cmake_knows_is_said_with_its_place(text: str, place: str, tmp_path: Path) -> None:
    jobs, unknown = found(project(tmp_path / "alone", f"{text}project(p C)\n"))
    assert (jobs, unknown) == ([], [f"error {place} cmake-not-understood"])
    project(tmp_path / "with another" / "sub", text)
    jobs, unknown = found(project(tmp_path / "with another", f"project(p C)\n{CALL}add_subdirectory(sub)\n"))
    assert ([job.request.name for job in jobs], unknown) == (["servo"], [f"warning {place} cmake-not-understood"])


@pytest.mark.parametrize(
    ("text", "tcf"),
    [
        ("if(NOT ROBOT)\nset(ROBOT a)\nendif()\n", "a"),
        ('if(NOT DEFINED ROBOT)\nset(ROBOT a CACHE STRING "")\nendif()\n', "a"),
        ("set(ROBOT a)\nif(WIN32)\nmessage(STATUS ROBOT)\nendif()\n", "a"),
        ("set(x b)\nif(x STREQUAL a OR (NOT x MATCHES ^a AND x))\nset(ROBOT a)\nelse()\nset(ROBOT b)\nendif()\n", "a"),
        ("set(which ROBOT)\nset(${which} a)\n", "a"),
        ("set(ROBOTS a a)\nforeach(ROBOT IN LISTS ROBOTS)\nendforeach()\n", "a"),
        ("set(ROBOT a)\nif(FALSE)\nset(ROBOT b)\nendif()\n", "a"),
        ("set(ROBOT a)\nif(0)\nreturn()\nendif()\n", "a"),
        ("string(REGEX REPLACE [/@].* x ROBOT a/b)\n", "ax"),
    ],
)
def test_values_that_are_written(text: str, tcf: str, tmp_path: Path) -> None:
    jobs, unknown = found(project(tmp_path, f"{text}epg_add_target(a TCF ${{ROBOT}} MODEL m BINDINGS b)\nproject(p)\n"))
    assert ([job.request.tcf for job in jobs], unknown) == ([tcf], [])


def test_what_cmake_does_not_reach_is_no_target(tmp_path: Path) -> None:
    assert found(project(tmp_path, f"project(p C)\nif(OFF)\n{CALL}endif()\nreturn()\n{CALL}")) == ([], [])


def test_no_project_no_message(tmp_path: Path) -> None:
    assert found(tmp_path) == ([], [])
    assert found(project(tmp_path, "project(p C)\nadd_executable(p main.c)\n")) == ([], [])


def test_a_folder_around_itself_ends(tmp_path: Path) -> None:
    project(tmp_path, f"project(p C)\nadd_subdirectory(.)\n{CALL}")
    assert [job.request.name for job in found(tmp_path)[0]] == ["servo"]
    loops = "foreach(a 0 1 2 3 4 5 6 7 8 9)\n" * 12 + "set(b ${a})\n" + "endforeach()\n" * 12
    assert [job.request.name for job in found(project(tmp_path / "x", f"project(p C)\n{CALL}{loops}"))[0]] == ["servo"]


def test_the_project_that_has_a_model(examples: Path, tmp_path: Path) -> None:
    assert [job.request.name for job in jobs_of_model(examples / "jiwy" / "model")] == ["jiwy"]
    below = jobs_of_model(examples / "existing_pico_repository" / "turntable" / "model")
    assert [(job.request.name, job.source_dir) for job in below] == [
        ("turntable", examples / "existing_pico_repository")
    ]
    assert jobs_of_model(examples / "jiwy" / "plant") == []
    assert jobs_of_model(tmp_path) == []


def test_the_same_text_as_cmake_reads(tmp_path: Path) -> None:
    """EPG's files and all modules of CMake are CMake to this reader."""
    script = tmp_path / "root.cmake"
    script.write_text('file(WRITE "${CMAKE_CURRENT_LIST_DIR}/root" "${CMAKE_ROOT}")\n')
    subprocess.run(["cmake", "-P", str(script)], check=True)
    modules = sorted(Path((tmp_path / "root").read_text(), "Modules").glob("*.cmake"))
    files = [*modules, *(ROOT / "cmake").glob("*.cmake"), ROOT / "tests" / "CMakeLists.txt"]
    assert len(files) > 100
    for path in files:
        try:
            parse_cmake(path.read_text(encoding="utf-8"), str(path))
        except NotCMake as problem:
            pytest.fail(f"{problem.span}: {problem}")


HOSTILE = {
    "parentheses": "a(" + "(" * 3000,
    "blocks": "if(A)\n" * 3000 + "endif()\n" * 3000,
    "references": "set(a " + "${" * 4000 + "b" + "}" * 4000 + ")\n",
    "negations": "if(" + "NOT " * 4000 + "A)\nendif()\n",
    "values that double": "set(a x)\n" + "set(a ${a}${a})\n" * 60,
    "lists that double": "set(a x;x)\n" + "set(a ${a} ${a})\n" * 60,
    "a slow test": f'if("{"a" * 60}!" MATCHES "^(a|a)*$")\nendif()\n',
    "a slow replacement": f'string(REGEX REPLACE "(a*)*b" "" r {"a" * 60})\n',
    "folders no system has": f'add_subdirectory("a\nb")\nadd_subdirectory({"x" * 5000})\n',
    "files no system has": f'if(EXISTS "/{"x" * 5000}")\nendif()\n',
    "NUL": "set(a \0)\n",
}


@pytest.mark.parametrize("name", HOSTILE)
def test_any_text_ends_soon(name: str, tmp_path: Path) -> None:
    start = time.process_time()
    found(project(tmp_path, f"project(p C)\n{HOSTILE[name]}{CALL}"))
    assert time.process_time() - start < 5
