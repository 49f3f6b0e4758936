# SPDX-License-Identifier: Apache-2.0
"""Builds that `epg connect` runs: real builds with real tools, on copies of an example."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import time
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from epg.connect import activity as build_module
from epg.connect.build.build_run import Build, configuration_of
from epg.connect.build.plan import make_plan
from epg.connect.projects import Job
from epg.generator.catalog.catalog import load_catalog
from epg.generator.data import targets_roots
from epg.generator.diagnostics import Diagnostics
from epg.generator.system import here
from epg.generator.tools.tools import load_tools
from tests.connect.builds import job_of, processes, run
from tests.connect.robots import ROOT, new_project
from tests.doubles.toolchain import arm_gcc, pico_sdk, skip_if_missing
from tests.waiting import until

COMPONENT = "position_pan: encoder_pan"


@pytest.fixture(scope="module")
def built(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """JIWY on the host, built once; the folder's name contains a space."""
    folder = tmp_path_factory.mktemp("jiwy") / "a robot"
    shutil.copytree(ROOT / "examples/jiwy", folder)
    edit(folder / "CMakeLists.txt", "${CMAKE_CURRENT_SOURCE_DIR}/../..", ROOT.as_posix())
    assert run(job_of(folder)).state()["state"] == "done"
    return folder


@pytest.fixture
def robot(built: Path) -> Iterator[Path]:
    """The project with a build; afterwards its files are restored."""
    before = {path: path.read_text() for path in built.iterdir() if path.is_file()}
    yield built
    for path in built.iterdir():
        if path.is_file() and path not in before:
            path.unlink()
        elif path.is_file() and path.read_text() != before[path]:
            path.write_text(before[path])


def edit(file: Path, old: str, new: str) -> None:
    text = file.read_text()
    assert old in text
    file.write_text(text.replace(old, new))


def append(robot: Path, text: str) -> None:
    """Adds lines to the project's CMakeLists.txt."""
    with (robot / "CMakeLists.txt").open("a") as file:
        file.write(text)


def messages(build: Build) -> list[tuple[str, str, int]]:
    return [(found["message"], Path(found["file"]).name, found["line"]) for found in build.state()["messages"]]


# targets and products -------------------------------------------------------------------------------------------------


def test_a_project_is_configured_and_built_and_its_program_runs(robot: Path) -> None:
    shutil.rmtree(robot / "build")
    states: list[dict[str, Any]] = []
    build = Build(lambda: states.append(build.state()))
    assert build.state()["state"] == "idle"
    build.start(job_of(robot))
    assert build.wait(300)
    state = build.state()
    assert state["state"] == "done" and state["messages"] == []
    assert states[-1]["state"] == "done", "the last change is told"
    steps = [seen["step"] for seen in states if seen["step"]]
    assert steps == sorted(steps, key=["configure", "build"].index) and set(steps) == {"configure", "build"}
    counts = [(seen["done"], seen["total"]) for seen in states if seen["step"] == "build" and seen["total"]]
    assert len(set(counts)) > 3 and counts == sorted(counts)
    assert state["done"] == state["total"] == counts[-1][1] > 50
    assert any("Building C object" in seen["action"] for seen in states)
    assert state["seconds"] > max(seen["seconds"] for seen in states[:-1]) - 0.1 > 0
    assert state["lines"] == len(build.lines(0)) > 50
    assert build.lines(state["lines"] - 1) == build.lines(0)[-1:]
    (product,) = state["products"]
    assert product["path"] == str(robot / "build/jiwy_host") and "--duration 5" in product["what"]
    done = subprocess.run([product["path"], "--duration", "0.1"], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr


def test_a_second_build_compiles_nothing_and_says_the_same(robot: Path) -> None:
    build = run(job_of(robot))
    assert build.state()["state"] == "done"
    assert [Path(product["path"]).name for product in build.state()["products"]] == ["jiwy_host"]
    assert not [line for line in build.lines(0) if "Building" in line]


def test_an_executable_of_ones_own_is_a_product_and_others_are_not(robot: Path) -> None:
    (robot / "own.c").write_text("int main(void)\n{\n    return 0;\n}\n")
    (robot / "other.c").write_text("int main(void)\n{\n    return 0;\n}\n")
    lines = "add_executable(own own.c)\ntarget_link_libraries(own PRIVATE EPG::jiwy)\nadd_executable(other other.c)\n"
    append(robot, lines)
    state = run(job_of(robot)).state()
    assert state["state"] == "done", state
    assert [Path(product["path"]).name for product in state["products"]] == ["jiwy_host", "own"]
    assert (robot / "build/other").is_file(), "all targets are built, as by cmake --build"


# errors ---------------------------------------------------------------------------------------------------------------


def test_a_mistake_in_the_bindings_is_said_once_in_epgs_words(robot: Path) -> None:
    edit(robot / "jiwy.bindings.yaml", COMPONENT, "position_pan: encodr_pan")
    build = run(job_of(robot))
    state = build.state()
    assert (state["state"], state["step"], state["products"]) == ("failed", "configure", [])
    assert state["messages"] == [
        {
            "severity": "error",
            "message": "there is no component 'encodr_pan'",
            "file": str(robot / "jiwy.bindings.yaml"),
            "line": 6,
            "column": 17,
            "hint": "did you mean 'encoder_pan'?",
            "id": "unknown-component",
            "port": None,
        }
    ]
    assert any("was not generated" in line for line in build.lines(0)), "the log has all"
    edit(robot / "jiwy.bindings.yaml", "encodr_pan", "encoder_pan")
    assert run(job_of(robot)).state()["state"] == "done"


def test_a_mistake_in_c_has_its_place(robot: Path) -> None:
    (robot / "own.c").write_text("int main(void)\n{\n    int unused;\n    return 0\n}\n")
    append(robot, "add_executable(own own.c)\ntarget_compile_options(own PRIVATE -Wall)\n")
    build = run(job_of(robot))
    state = build.state()
    assert (state["state"], state["step"]) == ("failed", "build")
    errors = [found for found in state["messages"] if found["severity"] == "error"]
    assert len(errors) == 1 and errors[0]["file"] == str(robot / "own.c")
    assert (errors[0]["line"], errors[0]["message"][:12]) == (4, "expected ‘;’")
    warnings = [found for found in state["messages"] if found["severity"] == "warning"]
    assert [(found["id"], found["line"]) for found in warnings] == [("-Wunused-variable", 3)]


def test_what_the_linker_misses_is_said_once(robot: Path) -> None:
    (robot / "own.c").write_text("int missing(void);\nint main(void)\n{\n    return missing() + missing();\n}\n")
    append(robot, "add_executable(own own.c)\n")
    build = run(job_of(robot))
    assert build.state()["state"] == "failed"
    assert messages(build) == [("undefined reference to `missing'", "own.c", 4)]


def test_a_failure_that_nobody_understands_is_its_last_lines(robot: Path) -> None:
    command = (
        'COMMAND "${CMAKE_COMMAND}" -E echo "the moon is in the wrong quarter" COMMAND "${CMAKE_COMMAND}" -E false'
    )
    append(robot, f"add_custom_target(own ALL {command})\n")
    (found,) = run(job_of(robot)).state()["messages"]
    assert found["id"] == "build-failed" and "the moon is in the wrong quarter" in found["message"]


def test_a_build_folder_of_another_project(robot: Path, tmp_path: Path) -> None:
    (tmp_path / "CMakeLists.txt").write_text("cmake_minimum_required(VERSION 3.22)\nproject(other NONE)\n")
    subprocess.run(["cmake", "-S", tmp_path, "-B", tmp_path / "build"], check=True, capture_output=True)
    build = run(replace(job_of(robot), build_dir=tmp_path / "build"))
    (found,) = build.state()["messages"]
    assert "does not match the source" in found["message"], found


@pytest.fixture
def pico(new_project: Path, tmp_path: Path) -> Path:
    return Path(shutil.copytree(new_project, tmp_path / "pico robot"))


def test_an_sdk_that_is_missing_comes_with_the_command_that_gets_it(
    pico: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    skip_if_missing(arm_gcc)
    monkeypatch.setenv("HOME", str(tmp_path / "home"))
    monkeypatch.setenv("EPG_CACHE", str(tmp_path / "cache"))
    monkeypatch.delenv("PICO_SDK_PATH", raising=False)
    state = run(job_of(pico)).state()
    assert (state["state"], state["step"], state["lines"]) == ("failed", "", 0), "nothing was started"
    assert state["seconds"] < 5 and state["can_try"]
    (found,) = state["messages"]
    assert found["message"] == "Raspberry Pi Pico SDK was not found"
    assert found["hint"].startswith("get it: git clone --depth 1 --branch 2.2.0 ")
    assert found["hint"].endswith(f" {tmp_path}/cache/pico-sdk-2.2.0"), "the command is whole"

    state = run(job_of(pico), anyway=True).state()
    found, picotool, *_ = state["messages"]
    assert (state["step"], found["message"]) == ("configure", "Raspberry Pi Pico SDK was not found.")
    assert picotool["message"].startswith("picotool was not found"), "CMake reports all that is missing at once"
    assert found["hint"].endswith(f" {tmp_path}/cache/pico-sdk-2.2.0")
    assert found["file"].startswith(str(pico)), "a file of the project, not of EPG"


def test_a_project_that_brings_the_sdk_is_not_stopped_once_it_is_configured(
    pico: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("HOME", str(tmp_path / "home"))
    monkeypatch.setenv("EPG_CACHE", str(tmp_path / "cache"))
    monkeypatch.delenv("PICO_SDK_PATH", raising=False)
    job = job_of(pico)
    configuration = configuration_of(job.request)
    assert not make_plan(job, configuration).steps and make_plan(job, configuration, anyway=True).steps
    (pico / "build/CMakeFiles").mkdir(parents=True)
    (pico / "build/CMakeFiles/TargetDirectories.txt").touch()  # CMake writes it at the end of a configuration
    assert make_plan(job, configuration).steps


def test_a_library_that_cannot_be_downloaded_is_named_before_cmake_starts(
    robot: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The middleware changes after the first build, on a computer without a network."""
    edit(robot / "CMakeLists.txt", "TCF host_jiwy.tcf", "TCF host_jiwy.tcf SET communication.middleware=xrce")
    monkeypatch.setenv("EPG_CACHE", str(tmp_path / "cache"))
    monkeypatch.setenv("HOME", str(tmp_path / "home"))
    monkeypatch.setenv("GIT_CONFIG_COUNT", "1")
    monkeypatch.setenv("GIT_CONFIG_KEY_0", f"url.file://{tmp_path}/nothing/.insteadOf")
    monkeypatch.setenv("GIT_CONFIG_VALUE_0", "https://github.com/")
    state = run(job_of(robot)).state()
    assert (state["state"], state["step"]) == ("failed", "download"), state
    assert [found["message"].partition(",")[0] for found in state["messages"]] == [
        "Micro-CDR was not found",
        "Micro XRCE-DDS client was not found",
    ]
    for found in state["messages"]:
        assert "cannot be downloaded from https://github.com/eProsima/Micro" in found["message"]
        assert found["hint"].startswith("get it: git clone --depth 1 ")
    with (robot / "build/CMakeCache.txt").open("a") as file:
        file.write("FETCHCONTENT_FULLY_DISCONNECTED:BOOL=ON\n")
    state = run(job_of(robot)).state()
    assert (state["state"], state["step"], len(state["messages"])) == ("failed", "", 2), "no download is tried"


def test_a_compiler_that_is_missing_is_named_as_doctor_does(
    pico: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """EPG names it even if CMake reports it first."""
    (tmp_path / "bin").mkdir()
    for program in ("cmake", "ninja", "python3"):
        found = shutil.which(program)
        if found is None:
            pytest.skip(f"{program} is not installed: 'epg doctor' says how to get it")
        (tmp_path / "bin" / program).symlink_to(os.path.realpath(found))
    monkeypatch.setenv("PATH", str(tmp_path / "bin"))
    monkeypatch.setenv("HOME", str(tmp_path / "home"))
    texts = {found["message"]: found["hint"] for found in run(job_of(pico)).state()["messages"]}
    named = [text for text in texts if "Arm GNU toolchain was not found" in text]
    assert len(named) == 1 and texts[named[0]].startswith("get it: "), texts


def test_without_cmake_nothing_is_started(robot: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    shutil.copytree(robot, tmp_path / "new", ignore=shutil.ignore_patterns("build"))
    monkeypatch.setenv("PATH", str(tmp_path))
    state = run(job_of(tmp_path / "new")).state()
    assert (state["state"], state["step"], state["lines"]) == ("failed", "", 0)
    found = {problem["message"]: problem["hint"] for problem in state["messages"]}
    assert found["CMake was not found"].startswith("get it: ")
    assert {problem["id"] for problem in state["messages"]} == {"tool-missing"}


# cancelling -----------------------------------------------------------------------------------------------------------


@pytest.mark.skipif(not Path("/proc/self/cmdline").exists(), reason="this system does not list processes in /proc")
@pytest.mark.parametrize(
    ("generator", "step"), [("Ninja", "configure"), ("Ninja", "build"), ("Unix Makefiles", "build")]
)
def test_a_cancelled_build_leaves_no_process_and_goes_on_later(
    robot: Path, tmp_path: Path, generator: str, step: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("CMAKE_GENERATOR", generator)
    folder = tmp_path / "cancelled"
    job = replace(job_of(robot), build_dir=folder)
    build = Build(lambda: None)
    build.start(job)

    def begun() -> bool:
        assert build.state()["state"] == "running", build.lines(0)
        return build.state()["step"] == step and build.lines(0) and build.state()["done"] >= (step == "build")

    until(begun, lambda: build.lines(0), 120)
    began = time.monotonic()  # the time that a user waits
    build.cancel()
    assert time.monotonic() - began < 1, "the user who cancels does not wait"  # the time that a user waits
    assert build.wait(20)
    assert processes(folder) == []
    assert (build.state()["state"], build.state()["products"]) == ("cancelled", [])
    assert build.state()["messages"] == []
    state = run(job).state()
    assert state["state"] == "done"
    assert [product["path"] for product in state["products"]] == [str(folder / "jiwy_host")]
    if generator == "Unix Makefiles":
        assert (state["done"], state["total"]) == (100, 100), "Make counts in hundredths"


def test_programs_are_found_without_proc(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """As on macOS: also a program in a process group of its own."""
    monkeypatch.setattr(sys, "platform", "darwin")
    script = "import os, signal\nif os.fork() == 0:\n    os.setpgid(0, 0)\n    os.write(1, b'.')\nsignal.pause()"
    group = here.start([sys.executable, "-c", script], tmp_path, os.environ, modest=False, bound=False)
    assert group.process.stdout is not None and group.process.stdout.read(1) == b"."
    group.process.kill()
    group.process.wait()
    assert group.is_running()
    group.kill()
    until(lambda: not group.is_running())


def test_cancelling_before_the_start_and_twice(robot: Path) -> None:
    build = Build(lambda: None)
    build.cancel()
    build.start(job_of(robot))
    build.cancel()
    assert build.wait(20) and build.state()["state"] == "cancelled"


# the run itself -------------------------------------------------------------------------------------------------------


def plan_of(job: Job) -> tuple[list[tuple[str, ...]], dict[str, str]]:
    plan = make_plan(job, None)
    return [step.command[1:] for step in plan.steps], dict(plan.environment)


def test_the_commands_are_those_a_person_types(robot: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("CMAKE_GENERATOR", raising=False)
    commands, _ = plan_of(job_of(robot))
    build = str(robot / "build")
    assert commands == [("-S", str(robot), "-B", build), ("--build", build)], "as the folder was configured"
    new_project(tmp_path / "new", "host_jiwy")
    commands, _ = plan_of(job_of(tmp_path / "new"))
    if shutil.which("ninja") is None:
        pytest.skip("Ninja is not installed: sudo apt install ninja-build")
    assert commands[0] == ("--preset", "release", "-B", str(tmp_path / "new/build"), "-G", "Ninja")
    monkeypatch.setenv("CMAKE_GENERATOR", "Unix Makefiles")
    assert "-G" not in plan_of(job_of(tmp_path / "new"))[0][0], "who has said which, keeps it"


def test_every_platform_says_what_builds_need_and_make() -> None:
    catalog = load_catalog(targets_roots(()), Diagnostics())
    tools = load_tools(targets_roots(()), Diagnostics())
    targets = [target for name in catalog.target_names() if (target := catalog.find_target(name)) is not None]
    assert len(targets) > 9
    for target in targets:
        platform = target.platform
        assert {"cmake", "build_program"} <= set(platform.needs) <= set(tools), platform.name
        assert platform.products and all(product.what for product in platform.products)
        if platform.built_by == "west":
            assert target.board.sdks[platform.sdk], "west needs the board's name"


def test_nothing_of_this_process_reaches_the_build(
    robot: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for name in (
        "CLICOLOR_FORCE",
        "MAKEFLAGS",
        "MAKELEVEL",
        "PYTHONHOME",
        "LC_ALL",
        "NINJA_STATUS",
        "EPG_DIR",
        "EPG_PATH",
    ):
        monkeypatch.setenv(name, "de_DE.UTF-8" if name == "LC_ALL" else "")
    for name in ("EPG_DIR", "EPG_PATH"):
        monkeypatch.delenv(name)
    monkeypatch.setenv("CLICOLOR_FORCE", "1")
    monkeypatch.setenv("NINJA_STATUS", "[%f/%t] ")
    _, environment = plan_of(job_of(robot))
    assert not {"CLICOLOR_FORCE", "MAKEFLAGS", "MAKELEVEL", "PYTHONHOME", "LC_ALL", "EPG_DIR"} & set(environment)
    assert environment["LC_MESSAGES"] == "C" and environment["LC_CTYPE"] == "de_DE.UTF-8"
    assert environment["NINJA_STATUS"] == "[%f/%t] "
    _, first = plan_of(replace(job_of(robot), build_dir=tmp_path / "new"))
    assert first["EPG_DIR"] == (ROOT / "cmake").as_posix(), "a new folder takes the EPG that runs"
    monkeypatch.setenv("EPG_PATH", "/somewhere")
    assert "EPG_DIR" not in plan_of(replace(job_of(robot), build_dir=tmp_path / "new"))[1]


def test_a_build_inside_a_build_is_no_part_of_it(robot: Path, tmp_path: Path) -> None:
    """Started as Make starts the target <name>_connect, with colours that a user has enabled."""
    script = tmp_path / "inside.py"
    script.write_text(
        f"import sys\nfrom pathlib import Path\nsys.path.insert(0, {str(ROOT)!r})\n"
        "from tests.connect.builds import job_of, run\n"
        f"build = run(job_of(Path({str(robot)!r})))\n"
        "print(build.state()['state'], sum('jobserver' in line for line in build.lines(0)))\n"
    )
    (tmp_path / "Makefile").write_text(f'all:\n\t+"$(PYTHON)" "{script}"\n')
    command = ["make", "-j2", "-C", str(tmp_path), f"PYTHON={sys.executable}"]
    if shutil.which("make") is None:
        pytest.skip("make is not installed: sudo apt install make")
    done = subprocess.run(
        command, capture_output=True, text=True, env={**os.environ, "CLICOLOR_FORCE": "1"}, check=False
    )
    assert "done 0\n" in done.stdout, done.stdout + done.stderr


def test_long_output_is_bounded(robot: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(build_module, "KEPT", 20)
    monkeypatch.setattr(build_module, "WIDEST", 100)
    append(
        robot, 'foreach(i RANGE 200)\nstring(REPEAT "x" 300 long)\nmessage(STATUS "line ${i} ${long}")\nendforeach()\n'
    )
    lines = (build := run(job_of(robot))).lines(0)
    assert len(lines) == build.state()["lines"] > 200, "line numbers stay what they were"
    assert lines[:-20] == [build_module.FORGOTTEN] * (len(lines) - 20)
    assert max(map(len, lines)) <= 100


def test_a_folder_where_the_first_try_failed_takes_the_epg_that_runs_too(
    pico: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    skip_if_missing(arm_gcc, pico_sdk)
    monkeypatch.delenv("EPG_PATH", raising=False)
    monkeypatch.delenv("EPG_DIR", raising=False)
    text = (pico / "CMakeLists.txt").read_text()
    (pico / "CMakeLists.txt").write_text(f'message(FATAL_ERROR "not yet")\n{text}')
    (found,) = run(job_of(pico)).state()["messages"]
    assert found["message"] == "not yet"
    assert (pico / "build/CMakeCache.txt").is_file()
    (pico / "CMakeLists.txt").write_text(text)
    assert plan_of(job_of(pico))[1]["EPG_DIR"] == (ROOT / "cmake").as_posix()
