# SPDX-License-Identifier: Apache-2.0
"""The targets that `epg connect` finds in a project without running CMake."""

from __future__ import annotations

import json
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from epg.connect.literal_calls import LiteralCalls
from epg.connect.projects import Job, find_jobs, jobs_of_model
from epg.generator.diagnostics import Diagnostics
from epg.generator.project import load_application
from tests.waiting import calls

ROOT = Path(__file__).resolve().parents[2]
EXAMPLES = ROOT / "examples"
CALL = "epg_add_target(servo TCF servo.tcf MODEL model BINDINGS servo.bindings.yaml)\n"


def project(folder: Path, text: str) -> Path:
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "CMakeLists.txt").write_text(text, encoding="utf-8")
    return folder


def found(folder: Path) -> tuple[list[Job], list[str]]:
    """The jobs, and the positions of calls that could not be read."""
    diagnostics = Diagnostics()
    jobs = find_jobs(folder, diagnostics)
    return jobs, [f"{d.severity} {d.span.line}:{d.span.column} {d.id}" for d in diagnostics]


def configured(folder: Path, source: Path, record: str = "", **variables: str) -> Path:
    """A build folder as after CMake, with ``record`` as the list of calls."""
    (folder / "CMakeFiles" / "epg").mkdir(parents=True)
    (folder / "CMakeFiles" / "epg" / "calls.txt").write_text(record)
    lines = [f"CMAKE_HOME_DIRECTORY:INTERNAL={source}", *(f"{name}:STRING={v}" for name, v in variables.items())]
    (folder / "CMakeCache.txt").write_text("\n".join(lines) + "\n")
    return folder


def recorded(source: Path, name: str, **options: str) -> str:
    """CMake's record of an epg_add_target() in the folder ``source``."""
    options = {"tcf": "servo.tcf", "model": str(source / "model"), "bindings": str(source / "b.yaml"), **options}
    options |= {"beside": str(source), "caller": str(source / "CMakeLists.txt")}
    words = [name, *(word for key, value in options.items() for word in (f"--{key.replace('_', '-')}", value))]
    return "epg_add_target\n" + "".join(f"\t{word}\n" for word in words)


NEEDS_CMAKE = {
    "existing_firmware/station/nucleo_h743zi": [],  # of another preset than the first one
    "existing_pico_repository": ["8:93"],
    "ping_pong": ["51:5"],
    "zephyr_jiwy/app": ["9:54", "12:27"],
}
"""Examples whose calls are not literal, with their positions."""
EXPECTED = {
    "existing_cubemx_repository": (["turntable"], "cmake", "build/Debug"),
    "existing_firmware": (["turntable"], "cmake", "build/host"),
    "existing_firmware/station": (["turntable"], "cmake", "../build/host"),
    "existing_zephyr_application": (["turntable"], "west", "build"),
    "jiwy": (["jiwy"], "cmake", "build"),
    "relbot": (["relbot"], "cmake", "build"),
    "zephyr_two_boards": (["axis"], "west", "build"),
    "zephyr_two_boards/tilt": (["axis"], "west", "build"),
}


@pytest.fixture(scope="module")
def examples(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A copy without any build folder."""
    folder = tmp_path_factory.mktemp("repository") / "examples"
    shutil.copytree(EXAMPLES, folder, ignore=shutil.ignore_patterns("build*"))
    return folder


def test_every_example_with_a_target_is_expected() -> None:
    files = [path for path in EXAMPLES.rglob("CMakeLists.txt") if "build" not in path.parts]
    calling = {str(path.parent.relative_to(EXAMPLES)) for path in files if "\nepg_add_target(" in path.read_text()}
    others = {"existing_pico_repository/turntable", "plugin"}  # the plug-in of the second one must be installed
    assert calling - others <= EXPECTED.keys() | NEEDS_CMAKE.keys()


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


def test_the_project_file_of_cubemx_is_an_argument_as_any_other(examples: Path) -> None:
    folder = examples / "existing_cubemx_repository"
    ((job,), _) = found(folder)
    assert job.request.ioc == folder / "station.ioc"
    with (folder / "station.ioc").open("a") as file:
        file.write("PD12.Signal=GPIO_Output\n")
    diagnostics = Diagnostics()
    assert load_application(job.request, diagnostics) is None
    assert [item.id for item in diagnostics] == ["other-code-pin"]
    shutil.copy(EXAMPLES / "existing_cubemx_repository" / "station.ioc", folder)


@pytest.mark.parametrize("example", NEEDS_CMAKE)
def test_examples_that_only_cmake_understands(example: str, examples: Path) -> None:
    places = [f"error {place} cmake-not-understood" for place in NEEDS_CMAKE[example]]
    assert found(examples / example) == ([], places)


def test_a_build_folder_says_what_cmake_has_made(examples: Path, tmp_path: Path) -> None:
    app = tmp_path / "app"
    shutil.copytree(examples / "zephyr_jiwy" / "app", app)
    record = recorded(app, "jiwy", tcf="rpi_pico2_zephyr_jiwy.tcf", set="control.period=2 ms", node="n")
    build = configured(app / "build", app, record, BOARD="rpi_pico2/rp2350a/m33")
    ((job,), unknown) = found(app)
    assert not unknown
    assert (job.request.tcf, job.board) == ("rpi_pico2_zephyr_jiwy.tcf", "rpi_pico2/rp2350a/m33")
    assert [text for text, _ in job.request.settings] == ["control.period=2 ms", "node=n"]
    assert (job.build_dir, job.built_by) == (build, "west")
    assert job.request.caller is not None and job.request.caller.line == 9


def test_what_cmake_configures_is_found(tmp_path: Path) -> None:
    """Loops, functions and included files: `epg connect` knows these targets after CMake has run."""
    shutil.copytree(EXAMPLES / "jiwy", tmp_path / "jiwy", ignore=shutil.ignore_patterns("build*"))
    top = tmp_path / "jiwy"
    (top / "robots.cmake").write_text("set(robots one two)\n")
    project(
        top,
        "cmake_minimum_required(VERSION 3.22)\nproject(p C)\n"
        f'include("{(ROOT / "cmake" / "epg_import.cmake").as_posix()}")\ninclude(robots.cmake)\n'
        "foreach(robot IN LISTS robots)\n  epg_add_target(${robot} TCF host_jiwy.tcf MODEL model\n"
        "    BINDINGS jiwy.bindings.yaml SET node=${robot})\n"
        "  epg_add_executable(${robot}_host EPG::${robot})\nendforeach()\n",
    )
    assert found(top) == ([], ["error 6:3 cmake-not-understood"])
    command = ["cmake", "-S", str(top), "-B", str(top / "out"), f"-DEPG_DIR={ROOT / 'cmake'}"]
    subprocess.run([*command, f"-DPython3_EXECUTABLE={sys.executable}"], check=True, capture_output=True)
    jobs, unknown = found(top)
    assert [(job.request.name, job.executables) for job in jobs] == [("one", ("one_host",)), ("two", ("two_host",))]
    assert not unknown and jobs[0].build_dir == top / "out"
    assert load_application(jobs[1].request, Diagnostics()) is not None


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


def test_the_build_folder_that_has_the_target_is_taken(tmp_path: Path) -> None:
    top = project(tmp_path, f"project(p C)\n{CALL}")
    configured(top / "build" / "board", top)
    configured(top / "build" / "other", tmp_path / "somewhere", recorded(top, "servo"))
    right = configured(top / "build" / "with_target", top, recorded(top, "servo"))
    ((job,), _) = found(top)
    assert job.build_dir == right


def test_calls_that_are_written_now_count(tmp_path: Path) -> None:
    """The present text has priority over the record of an older configure run."""
    top = project(tmp_path, f"project(p C)\n{CALL}")
    build = configured(top / "other", top, recorded(top, "servo", tcf="old.tcf") + recorded(top, "removed"))
    ((job,), _) = found(top)
    assert (job.request.name, job.request.tcf, job.build_dir) == ("servo", "servo.tcf", build)


def test_presets(tmp_path: Path) -> None:
    top = project(tmp_path, f"project(p C)\n{CALL}")
    presets = [
        {"name": "base", "hidden": True, "binaryDir": "${sourceDir}/out/${presetName}"},
        {"name": "x", "inherits": "base"},
        {"name": "y", "inherits": ["base"], "binaryDir": "${sourceDir}/other"},
    ]
    (top / "CMakePresets.json").write_text(json.dumps({"version": 3, "configurePresets": presets}))
    ((job,), _) = found(top)
    assert (job.preset, job.build_dir) == ("x", top / "out" / "x")
    built = configured(top / "other", top)
    ((job,), _) = found(top)
    assert (job.preset, job.build_dir) == ("y", built)


@pytest.mark.parametrize(
    "name", ["a" * 5000, "a/" * 3000, "\0", "${sourceDir}/" + "b" * 300], ids=["long", "deep", "nul", "b"]
)
def test_a_build_folder_that_no_system_can_have(name: str, tmp_path: Path) -> None:
    """CMake reports the error when it configures."""
    top = project(tmp_path, "project(p C)\nepg_add_target(servo TCF t.tcf MODEL m BINDINGS b.yaml)\n")
    presets = [{"name": "x", "binaryDir": name}]
    (top / "CMakePresets.json").write_text(json.dumps({"version": 3, "configurePresets": presets}))
    ((job,), _) = found(top)
    assert (job.request.tcf, job.preset) == ("t.tcf", "x")


def test_all_that_a_call_can_say(tmp_path: Path) -> None:
    folder = project(
        tmp_path,
        "project(p C)\n#[[ epg_add_target(not_this TCF a MODEL b BINDINGS c) ]]\n"
        'set(EPG_TARGETS_PATH "my targets;/other")\nset(unused ${models})\n'
        'EPG_Add_Target(servo # comment ")\n  BINDINGS [=[b [1].yaml]=] TCF "a \\"b\\".tcf"'
        " MODEL ${CMAKE_CURRENT_LIST_DIR}/x/../m\n"
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
        ("epg_add_target(a SYSTEM s.system.yaml)\n", "1:1"),
        ("epg_add_target()\n", "1:1"),
        ("function(robot name)\n  epg_add_target(${name} TCF x MODEL m BINDINGS b)\nendfunction()\n", "2:3"),
        ("add_subdirectory(${ROBOT})\n", "1:18"),
        ("foreach(a b c)\nif(A)\nendif()\nepg_add_target(a TCF t MODEL m BINDINGS b)\nendforeach()\n", "4:1"),
        ('epg_add_target(a TCF "t)\n', "1:22"),
        ("epg_add_target(a\n", "1:1"),
    ],
)
def test_what_only_cmake_knows_is_said_with_its_place(text: str, place: str, tmp_path: Path) -> None:
    jobs, unknown = found(project(tmp_path / "alone", f"{text}project(p C)\n"))
    assert (jobs, unknown) == ([], [f"error {place} cmake-not-understood"])
    project(tmp_path / "with another" / "sub", text)
    jobs, unknown = found(project(tmp_path / "with another", f"project(p C)\n{CALL}add_subdirectory(sub)\n"))
    assert ([job.request.name for job in jobs], unknown) == (["servo"], [f"warning {place} cmake-not-understood"])


def test_a_call_under_a_condition_is_taken_as_one_that_is_made(tmp_path: Path) -> None:
    project(tmp_path / "sub", CALL)
    top = project(tmp_path, "project(p C)\nif(ROBOT)\n  add_subdirectory(sub)\nendif()\n")
    ((job,), unknown) = found(top)
    assert (job.request.name, unknown) == ("servo", [])


def test_no_project_no_message(tmp_path: Path) -> None:
    assert found(tmp_path) == ([], [])
    assert found(project(tmp_path, "project(p C)\nadd_executable(p main.c)\n")) == ([], [])


def test_one_of_two_calls_is_chosen_by_cmake(tmp_path: Path) -> None:
    top = project(tmp_path, f"project(p C)\nif(ROBOT)\n{CALL}else()\n{CALL}endif()\n")
    jobs, unknown = found(top)
    assert ([job.request.name for job in jobs], unknown) == (["servo"], ["warning 5:1 cmake-not-understood"])
    configured(top / "build", top, recorded(top, "servo", tcf="second.tcf"))
    ((job,), unknown) = found(top)
    assert (job.request.tcf, unknown) == ("second.tcf", [])


def test_a_folder_around_itself_ends(tmp_path: Path) -> None:
    project(tmp_path, f"project(p C)\nadd_subdirectory(.)\n{CALL}")
    assert [job.request.name for job in found(tmp_path)[0]] == ["servo"]


def test_the_project_that_has_a_model(examples: Path, tmp_path: Path) -> None:
    assert [job.request.name for job in jobs_of_model(examples / "jiwy" / "model")] == ["jiwy"]
    below = jobs_of_model(examples / "existing_firmware" / "station" / "model")
    assert [(job.request.name, job.source_dir) for job in below] == [("turntable", examples / "existing_firmware")]
    assert jobs_of_model(examples / "jiwy" / "plant") == []
    assert jobs_of_model(tmp_path) == []


def test_the_same_text_as_cmake_reads(tmp_path: Path) -> None:
    """EPG's files and all modules of CMake belong to CMake for this reader."""
    script = tmp_path / "root.cmake"
    script.write_text('file(WRITE "${CMAKE_CURRENT_LIST_DIR}/root" "${CMAKE_ROOT}")\n')
    subprocess.run(["cmake", "-P", str(script)], check=True)
    modules = sorted(Path((tmp_path / "root").read_text(), "Modules").glob("*.cmake"))
    files = [*modules, *(ROOT / "cmake").glob("*.cmake"), ROOT / "tests" / "CMakeLists.txt"]
    assert len(files) > 100
    for path in files:
        folder = project(tmp_path / path.stem, path.read_text(encoding="utf-8"))
        problems = [problem for problem in LiteralCalls(folder).unknown if "not understood" in problem.message]
        assert not problems, f"{path}: {problems}"


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
    folder = project(tmp_path, f"project(p C)\n{HOSTILE[name]}{CALL}")
    assert calls(lambda: found(folder))[1] < 1_500_000
