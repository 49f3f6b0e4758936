# SPDX-License-Identifier: Apache-2.0
"""Projects that use EPG as a user does."""

from __future__ import annotations

import json
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from epg.generator.check.editor_schemas import USER_FILES
from tests.cmake.project import CMAKE_DIR, ROOT, Project, compiled, snapshot


@pytest.fixture
def robot(tmp_path: Path) -> Project:
    return Project(tmp_path, "robot")


@pytest.mark.parametrize("generator", ["Ninja", "Unix Makefiles"])
def test_configure_build_run(robot: Project, generator: str) -> None:
    before = snapshot(robot.source)
    robot.configure(generator=generator)
    robot.build()
    done = subprocess.run([robot.build_folder / "robot_host", "--duration", "0.5"], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert "500" in done.stdout
    assert snapshot(robot.source) == before, "EPG wrote into the source tree"


def test_a_build_without_a_change_and_a_comment_in_the_tcf_compile_nothing(robot: Project) -> None:
    robot.configure()
    robot.build()
    assert compiled(robot.build()) == set()
    robot.configure()
    assert compiled(robot.build()) == set()
    robot.edit("robot.tcf", "# A motor", "# The motor\n# and its load: a motor")
    output = robot.build()
    assert "Re-running CMake" in output or "Configuring done" in output
    assert compiled(output) == set()


def test_a_changed_value_compiles_the_tables_only_and_a_changed_model_is_noticed(robot: Project) -> None:
    robot.configure(generator="Ninja")  # Make prints less about compiled files
    robot.build()
    robot.edit("robot.tcf", "counts_per_revolution: 4096", "counts_per_revolution: 2048")
    assert "robot_app.c" in compiled(robot.build())
    robot.edit("robot.tcf", "node: robot", "node: robot2")
    assert compiled(robot.build()) == {"robot_app.c", "robot_version.c"}
    robot.edit("model/controller.c", "outputs->reset = 0.0", "outputs->reset = 1.0")
    assert "controller.c" in compiled(robot.build())
    robot.edit("model/model.yaml", "log: {unit: rad}", "log: {unit: deg}")
    output = robot.build()
    assert "Configuring done" in output


def test_a_mistake_stops_the_build_with_its_position_and_mending_it_helps(robot: Project) -> None:
    robot.configure()
    robot.build()
    robot.edit("bindings.yaml", "duty: motor", "duty: moter")
    output = robot.build(check=False)
    assert f"{robot.source}/bindings.yaml:4:17: error: there is no component 'moter' [unknown-component]\n" in output
    assert "hint: did you mean 'motor'?" in output
    assert "target 'robot' was not generated" in output
    robot.edit("bindings.yaml", "duty: moter", "duty: motor")
    robot.build()


def test_a_mistake_in_the_first_configuration_leaves_nothing_half_written(robot: Project) -> None:
    robot.edit("robot.tcf", "frequency: 20 kHz", "frequency: 20")
    output = robot.fails_to_configure()
    assert "robot.tcf:8:42: error: this frequency has no unit [wrong-unit]" in output
    assert output.count("CMake Error") == 1, output
    assert not list((robot.build_folder / "epg").rglob("*.c"))


def test_the_browser_is_not_offered_where_epg_itself_does_not_run(robot: Project) -> None:
    cache = robot.folder / "cache"
    cache.mkdir()
    cache.chmod(0o777)  # EPG runs no program from a cache that others may change
    robot.environment["EPG_CACHE"] = str(cache)
    output = robot.fails_to_configure()
    assert "EPG does not use its cache" in output
    assert "target 'robot' was not generated" in output
    assert "in a browser" not in output
    cache.chmod(0o700)
    robot.edit("bindings.yaml", "duty: motor", "duty: moter")
    assert "connected in a browser" in robot.fails_to_configure()


def test_compile_commands_find_all_headers_right_after_configure(robot: Project) -> None:
    robot.configure()
    commands = json.loads((robot.build_folder / "compile_commands.json").read_text())
    assert any(command["file"].endswith("robot_app.c") for command in commands)
    for command in commands:
        words = command["command"].replace("-o ", "-fsyntax-only -o ", 1)
        done = subprocess.run(words, shell=True, cwd=command["directory"], capture_output=True, text=True)
        assert done.returncode == 0, done.stderr


def test_output_is_the_same_in_another_folder(tmp_path: Path) -> None:
    texts = []
    for name in ("one", "a folder with blanks"):
        project = Project(
            tmp_path / name, "robot", {"PYTHONHASHSEED": "1" if name == "one" else "2", "TZ": "Asia/Tokyo"}
        )
        project.configure()
        texts.append(snapshot(project.build_folder / "epg" / "robot"))
    assert texts[0] == texts[1]
    project.build()


@pytest.mark.parametrize("generator", ["Ninja", "Unix Makefiles"])
def test_two_targets_own_main_and_strict_warnings(tmp_path: Path, generator: str) -> None:
    project = Project(tmp_path, "own_main")
    project.configure(f"-DEPG_PATH={ROOT}", generator=generator, epg_dir=False)
    project.build()
    done = subprocess.run([project.build_folder / "src" / "firmware"], capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr
    assert done.stdout.startswith("cycles ")
    assert done.stdout.endswith("enabled 1\n")


def test_settings_reach_the_generated_code(tmp_path: Path) -> None:
    project = Project(tmp_path, "own_main")
    project.configure(f"-DEPG_PATH={ROOT}", epg_dir=False)
    text = (project.build_folder / "epg" / "left" / "left_app.c").read_text()
    assert '.node = "left_node"' in text
    assert '.name_space = "/lab"' in text
    assert ".enable_at_start = false" in text


def test_a_wrong_setting_names_the_cmakelists(tmp_path: Path) -> None:
    project = Project(tmp_path, "own_main")
    project.edit("src/CMakeLists.txt", "components.motor.invert=true", "components.motor.inverted=true")
    project.edit("src/CMakeLists.txt", "foreach(side left right)", "foreach(side left)")
    output = project.fails_to_configure(f"-DEPG_PATH={ROOT}", epg_dir=False)
    assert f"{project.source}/src/CMakeLists.txt:" in output
    assert "unknown key 'inverted'" in output


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("TCF robot.tcf ", "", "epg_add_target(robot): TCF is missing"),
        ("MODEL model", "MODEL model PINS x", "epg_add_target(robot): unknown argument: PINS"),
        ("BINDINGS bindings.yaml", "BINDINGS", "this keyword has no value: BINDINGS"),
        ("MODEL model", "MODLE model", "Usage: epg_add_target(<name> TCF <file> MODEL <folder> BINDINGS <file>"),
        ("TCF robot.tcf", "tcf robot.tcf", "Write 'TCF <value>': keywords are in capitals"),
        ("TCF robot.tcf", "TCF=robot.tcf", "Write 'TCF <value>': keywords are in capitals"),
        ("robot TCF", "robot, TCF", "CMake separates arguments by blanks: remove the commas"),
        ("robot TCF", "TCF", "epg_add_target(TCF ...): the first argument must be a name."),
        ("BINDINGS bindings.yaml", "BINDINGS bindings.yaml PLANT plant", "PLANT needs PLANT_BINDINGS"),
        ("LANGUAGES C", "LANGUAGES NONE", "EPG needs C: write project(robot LANGUAGES"),
        ("epg_add_executable(robot_host EPG::robot)", "epg_add_executable(x EPG::other)", "call epg_add_target(other"),
        (
            "epg_add_executable",
            "add_library(a INTERFACE)\nepg_add_target(a TCF x MODEL y BINDINGS z)\n#",
            "a target with this name exists already",
        ),
    ],
)
def test_wrong_calls_say_what_to_write(robot: Project, old: str, new: str, message: str) -> None:
    robot.edit("CMakeLists.txt", old, new)
    assert message in " ".join(robot.fails_to_configure().split())


def test_the_version_is_the_packages(robot: Project) -> None:
    robot.edit(
        "CMakeLists.txt",
        "find_package(EPG REQUIRED)",
        'find_package(EPG REQUIRED)\nmessage(STATUS "is ${EPG_VERSION}")',
    )
    import epg

    assert f"is {epg.__version__}\n" in robot.configure()
    robot.edit("CMakeLists.txt", "find_package(EPG REQUIRED)", "find_package(EPG 99 REQUIRED)")
    assert "compatible with requested version" in " ".join(robot.fails_to_configure().split())


def copied_checkout(folder: Path) -> Path:
    """A copy of EPG without its tests, of which its CMakeLists.txt registers none."""
    unneeded = shutil.ignore_patterns("__pycache__", "editor")
    for tree in ("cmake", "epg", "schemas", "targets"):
        shutil.copytree(ROOT / tree, folder / tree, ignore=unneeded)
    (folder / "tests").mkdir()
    (folder / "tests/CMakeLists.txt").write_text("")
    shutil.copy(ROOT / "CMakeLists.txt", folder)
    return folder


def configure(checkout: Path, build: Path) -> None:
    command = ["cmake", "-S", checkout, "-B", build, f"-DPython3_EXECUTABLE={sys.executable}"]
    subprocess.run(command, check=True, capture_output=True)


def test_the_first_configuration_of_a_checkout_writes_the_schemas_for_editors(tmp_path: Path) -> None:
    checkout = copied_checkout(tmp_path / "checkout")
    configure(checkout, tmp_path / "build")
    written = {path.name for path in (checkout / "schemas/editor").iterdir()}
    assert written == {f"{name}.schema.json" for name in USER_FILES}


def test_a_checkout_that_cannot_be_written_is_configured(tmp_path: Path) -> None:
    checkout = copied_checkout(tmp_path / "checkout")
    (checkout / "schemas").chmod(0o500)
    shutil.rmtree(checkout / "epg/cli")  # root may write everywhere, so the command fails for another reason, too
    configure(checkout, tmp_path / "build")
    assert not (checkout / "schemas/editor").exists()


def test_nothing_is_written_into_a_submodule(robot: Project, tmp_path: Path) -> None:
    checkout = copied_checkout(tmp_path / "checkout")
    robot.edit("CMakeLists.txt", "find_package(EPG REQUIRED)", f'add_subdirectory("{checkout}" epg_checkout)')
    robot.configure(epg_dir=False)
    assert not (checkout / "schemas/editor").exists()


def test_add_subdirectory(robot: Project) -> None:
    robot.edit("CMakeLists.txt", "find_package(EPG REQUIRED)", f'add_subdirectory("{ROOT}" epg_checkout)')
    robot.configure(epg_dir=False)
    robot.build()


PICO_CONVENTIONS = """
set(CMAKE_SYSTEM_NAME Linux)
set(CMAKE_FIND_ROOT_PATH /nowhere)
set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
set(CMAKE_FIND_ROOT_PATH_MODE_LIBRARY ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_INCLUDE ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_PACKAGE ONLY)
"""


@pytest.mark.parametrize("where", ["before project()", "after project()"])
def test_import_file_under_a_toolchain_that_confines_packages(robot: Project, where: str) -> None:
    (robot.source / "toolchain.cmake").write_text(PICO_CONVENTIONS)
    (robot.source / "epg_import.cmake").write_text((CMAKE_DIR / "epg_import.cmake").read_text())
    robot.edit("CMakeLists.txt", "find_package(EPG REQUIRED)", "")
    line = "project(robot LANGUAGES C)"
    include = "include(epg_import.cmake)"
    robot.edit("CMakeLists.txt", line, f"{include}\n{line}" if where.startswith("before") else f"{line}\n{include}")
    robot.configure(f"-DCMAKE_TOOLCHAIN_FILE={robot.source}/toolchain.cmake", f"-DEPG_PATH={ROOT}", epg_dir=False)


@pytest.mark.parametrize("name", ["a|b", "a${PROJECT_NAME}b", "a$ENV{HOME}b", "a#b", "a<b", "a?b", "a[b", "a]]b[["])
def test_folders_that_cmake_or_make_would_read_otherwise(name: str, tmp_path: Path) -> None:
    robot = Project(tmp_path / name, "robot")
    output = robot.fails_to_configure()
    assert "EPG: a folder's name cannot be used in CMake: " in " ".join(output.split())
    assert f"  {robot.source}\n" in output and output.count("CMake Error") == 1


def test_folders_with_other_signs_are_fine(tmp_path: Path) -> None:
    robot = Project(tmp_path / "a $b {c} @d@ %e & (f) 'g' [1] ~=,^!", "robot")
    robot.configure()
    robot.build()
    assert (robot.build_folder / "robot_host").is_file()


@pytest.mark.parametrize("name", ["$(HOME).yaml", "a$(b).yaml", "a|b.yaml", "a${b}.yaml", "$ENV{HOME}.yaml"])
def test_paths_that_cmake_or_make_would_read_otherwise(robot: Project, name: str) -> None:
    (robot.source / "bindings.yaml").rename(robot.source / name)
    robot.edit("CMakeLists.txt", "BINDINGS bindings.yaml", f"BINDINGS [=[{name}]=]")
    output = robot.fails_to_configure()
    assert f"{name}' cannot be used in CMake: " in output and "[invalid-name]" in output


def test_a_target_before_project(robot: Project) -> None:
    """As in an application of Zephyr, in which targets for Zephyr come before find_package(Zephyr)."""
    robot.edit("CMakeLists.txt", "project(robot LANGUAGES C)", "")
    robot.edit("CMakeLists.txt", "epg_add_executable", "project(robot LANGUAGES C)\nepg_add_executable")
    output = robot.fails_to_configure()
    text = " ".join(output.split())
    assert output.count("CMake Error") == 1, output
    assert "EPG: EPG needs C, and project() has not been called yet." in text
    assert "Write project(<name> LANGUAGES C) before the call of EPG." in text


def test_a_build_folder_whose_path_is_too_long_for_windows(tmp_path: Path) -> None:
    robot = Project(tmp_path / "/".join(["a long folder"] * 12), "robot")
    robot.edit("CMakeLists.txt", "find_package(EPG REQUIRED)", "set(CMAKE_HOST_WIN32 TRUE)\nfind_package(EPG REQUIRED)")
    text = " ".join(robot.configure().split())
    assert f"EPG: the path of the build folder has {len(str(robot.build_folder))} characters" in text
    assert "choose another build folder: cmake -B C:/build ..." in text


@pytest.mark.parametrize(
    ("settings", "problem"),
    [
        (
            'set(CMAKE_HOST_WIN32 TRUE)\nset(CMAKE_GENERATOR "NMake Makefiles")\n',
            "EPG: CMake uses the generator 'NMake Makefiles', whose compiler cannot build EPG's libraries.",
        ),
        (
            'set(CMAKE_HOST_WIN32 TRUE)\nset(CMAKE_GENERATOR "Visual Studio 17 2022")\n',
            "EPG: CMake uses the generator 'Visual Studio 17 2022', whose compiler cannot build EPG's libraries.",
        ),
        ("set(CMAKE_C_COMPILER_ID MSVC)\n", "MSVC, and Clang in its place, are not supported."),
        (
            "set(CMAKE_C_COMPILER_ID Clang)\nset(CMAKE_C_SIMULATE_ID MSVC)\n",
            "MSVC, and Clang in its place, are not supported.",
        ),
    ],
)
@pytest.mark.parametrize("before", ["find_package(EPG REQUIRED)", "epg_add_target("])
def test_compilers_of_microsoft(before: str, settings: str, problem: str, robot: Project) -> None:
    robot.edit("CMakeLists.txt", before, f"{settings}{before}")
    output = robot.fails_to_configure()
    text = " ".join(output.split())
    assert output.count("CMake Error") == 1, output
    assert f"{problem} Get it: " in text
    if "WIN32" in settings:
        assert "Ninja starts the compiler. Get it: " in text
        assert "configure in an empty build folder: cmake -B build -G Ninja -DCMAKE_C_COMPILER=gcc" in text


@pytest.mark.parametrize(("target", "refused"), [("host_jiwy.tcf", True), ("rpi_pico_bare_metal_jiwy.tcf", False)])
def test_a_computer_without_a_compiler(target: str, refused: bool, robot: Project, tmp_path: Path) -> None:
    """Before project(), which would say less.  Images of microcontrollers do not need this compiler."""
    (tmp_path / "programs").mkdir()
    for name in ("cmake", "ninja", "make"):
        program = shutil.which(name)
        if program:
            (tmp_path / "programs" / name).symlink_to(program)
    robot.environment["PATH"] = str(tmp_path / "programs")
    robot.environment["CC"] = ""
    robot.edit("CMakeLists.txt", "project(robot LANGUAGES C)", "find_package(EPG REQUIRED)\nproject(robot LANGUAGES C)")
    robot.edit("CMakeLists.txt", "robot.tcf", target)
    text = " ".join(robot.fails_to_configure().split())
    assert ("EPG: this computer has no C compiler. Get it: " in text) == refused, text


def test_the_link_to_the_microsoft_store_is_not_python(robot: Project, tmp_path: Path) -> None:
    stub = tmp_path / "Microsoft/WindowsApps/python3"
    stub.parent.mkdir(parents=True)
    stub.write_text("#!/bin/sh\necho 'Python was not found; run without arguments to install' >&2\nexit 9\n")
    stub.chmod(0o755)
    robot.edit("CMakeLists.txt", "find_package(EPG REQUIRED)", "set(CMAKE_HOST_WIN32 TRUE)\nfind_package(EPG REQUIRED)")
    text = " ".join(robot.fails_to_configure(f"-DPython3_EXECUTABLE={stub}").split())
    assert f"This is not Python: it is Windows' link to the Microsoft Store: {stub}" in text
    assert "Get it, and open a new terminal: winget install Python.Python.3.13" in text


@pytest.mark.parametrize("system", ["Generic", "PICO", "FreeBSD"])
def test_a_host_target_in_a_project_for_another_system(robot: Project, system: str) -> None:
    (robot.source / "cmake/Platform").mkdir(parents=True)
    (robot.source / "cmake/Platform/PICO.cmake").write_text("include(Platform/UnixPaths)\n")  # as the Pico SDK does
    (robot.source / "toolchain.cmake").write_text(
        f"set(CMAKE_SYSTEM_NAME {system})\n"
        "list(APPEND CMAKE_MODULE_PATH ${CMAKE_CURRENT_LIST_DIR}/cmake)\n"
        "set(CMAKE_TRY_COMPILE_TARGET_TYPE STATIC_LIBRARY)\n"
    )
    output = robot.fails_to_configure(f"-DCMAKE_TOOLCHAIN_FILE={robot.source}/toolchain.cmake")
    text = " ".join(output.split())
    assert output.count("CMake Error") == 1, output
    assert "robot): its target is 'host', a program for Linux, macOS or Windows, and this project is" in text
    assert f"compiled for another system, such as a microcontroller (CMAKE_SYSTEM_NAME is {system})" in text
    assert "write 'target: firmware' in the .tcf" in text
    assert "epg_add_model(robot MODEL <folder>)" in text
