# SPDX-License-Identifier: Apache-2.0
"""CMake's message if a part is missing or does not fit: one sentence, and its remedy."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from tests.doubles.toolchain import ROOT, arm_gcc, pico_sdk, skip_if_missing, tool
from tests.platforms.pico.images import freertos_kernel, skip_unless_buildable

SDK = """
epg_import_pico_sdk()
project(firmware C CXX ASM)
pico_sdk_init()
"""
NO_SDK = """
project(firmware C)
"""
TARGET = f"""
epg_add_target(jiwy TCF rpi_pico_{{platform}}_jiwy.tcf MODEL {ROOT}/examples/jiwy/model
  BINDINGS {ROOT}/examples/jiwy/jiwy.bindings.yaml SET {{communication}})
"""
EXECUTABLE = """
epg_add_executable(jiwy_firmware EPG::jiwy)
"""
NONE = "communication.middleware=none communication.transport=null communication.console=null"
XRCE = "communication.middleware=xrce"
CONSOLE = "communication.middleware=console"


def target(platform: str = "bare_metal", communication: str = NONE) -> str:
    return TARGET.format(platform=platform, communication=communication)


def configure(folder: Path, text: str, *arguments: str, bare: bool = False, **environment: str) -> str:
    """CMake's output for a project, on one line; ``bare``: no tool is installed in its usual place."""
    return " ".join(output(folder, text, *arguments, bare=bare, **environment).split())


def output(folder: Path, text: str, *arguments: str, bare: bool = False, **environment: str) -> str:
    (folder / "CMakeLists.txt").write_text(
        f"cmake_minimum_required(VERSION 3.22)\ninclude({ROOT}/cmake/epg_import.cmake)\n{text}", encoding="utf-8"
    )
    variables = {k: v for k, v in os.environ.items() if not k.startswith(("PICO_", "EPG_", "FREERTOS_", "picotool"))}
    if bare:
        (folder / "home").mkdir(exist_ok=True)
        variables |= {"HOME": str(folder / "home"), "XDG_CACHE_HOME": str(folder / "home" / "cache")}
    command = ["cmake", "-S", str(folder), "-B", str(folder / "build"), "-G", "Ninja", f"-DEPG_PATH={ROOT}"]
    command += [f"-DPython3_EXECUTABLE={sys.executable}", *arguments]
    done = subprocess.run(
        command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, env=variables | environment
    )
    assert (done.returncode == 0) == ("CMake Error" not in done.stdout)
    return done.stdout


def test_a_project_without_the_sdk(tmp_path: Path) -> None:
    said = configure(tmp_path, NO_SDK + target() + EXECUTABLE)
    assert "epg_add_target(jiwy): its target is built with the Raspberry Pi Pico SDK, which is not initialised" in said
    assert 'set(PICO_BOARD pico CACHE STRING "Board")' in said
    assert "pico_sdk_init()" in said
    assert said.count("CMake Error") == 1


def test_a_board_without_a_name_in_the_sdk(tmp_path: Path) -> None:
    board = tmp_path / "targets" / "boards" / "motor_board"
    board.mkdir(parents=True)
    text = (ROOT / "targets/boards/rpi_pico/board.yaml").read_text(encoding="utf-8")
    text = text.replace("board: rpi_pico\n", "board: motor_board\n").replace("{pico_sdk: pico, ", "{")
    (board / "board.yaml").write_text(text, encoding="utf-8")
    (tmp_path / "robot.tcf").write_text(
        "version: 1\nextends: rpi_pico_bare_metal_jiwy.tcf\ntarget: motor_board_bare_metal\n"
    )
    robot = target().replace("rpi_pico_bare_metal_jiwy.tcf", "robot.tcf")
    said = configure(tmp_path, NO_SDK + robot, f"-DEPG_TARGETS_PATH={tmp_path}/targets")
    assert "epg_add_target(jiwy): its board has no name in the Pico SDK. Add to its board.yaml:" in said
    assert "sdks: {pico_sdk: pico}" in said
    assert said.count("CMake Error") == 1


def test_a_variable_that_leads_elsewhere(tmp_path: Path) -> None:
    skip_if_missing(arm_gcc)
    said = configure(tmp_path, SDK, PICO_SDK_PATH=str(tmp_path))
    assert "The environment variable PICO_SDK_PATH does not lead to the Raspberry Pi Pico SDK" in said


def test_an_sdk_that_is_too_old(tmp_path: Path) -> None:
    skip_if_missing(arm_gcc)
    old = tmp_path / "sdk"
    old.mkdir()
    (old / "pico_sdk_init.cmake").touch()
    version = "set(PICO_SDK_VERSION_MAJOR 1)\nset(PICO_SDK_VERSION_MINOR 5)\nset(PICO_SDK_VERSION_REVISION 1)\n"
    (old / "pico_sdk_version.cmake").write_text(version)
    said = configure(tmp_path, SDK, f"-DPICO_SDK_PATH={old}")
    assert "is 1.5.1; EPG needs 2.0.0 or newer. Get it: git clone" in said


PARTS = ("git", "arm_gcc", "pico_sdk", "picotool", "freertos_kernel", "micro_cdr", "micro_xrce_dds_client")


@pytest.mark.parametrize("cache", ["cache", "my cache"])
def test_all_that_is_missing_is_said_at_once(cache: str, tmp_path: Path) -> None:
    """On a bare computer, one run reports each missing part with the command of `epg doctor`, on one line."""
    path = tmp_path / "bin"
    path.mkdir()
    for program in ("cmake", "ninja", "id"):
        (path / program).symlink_to(shutil.which(program) or "")
    bare = {"PATH": str(path), "EPG_CACHE": str(tmp_path / cache)}
    arguments = ["-DCMAKE_FIND_USE_CMAKE_SYSTEM_PATH=FALSE", "-DFETCHCONTENT_FULLY_DISCONNECTED=ON"]
    said = output(tmp_path, SDK + target("freertos", XRCE), *arguments, bare=True, **bare)
    lines = [line.strip() for line in said.splitlines()]
    environment = {"HOME": str(tmp_path / "home"), "EPG_NO_INSTALL": "1", **bare}
    command = [sys.executable, str(ROOT / "epg"), "doctor", "--json"]
    items = json.loads(subprocess.run(command, capture_output=True, text=True, env=environment).stdout)["items"]
    remedies = {item["name"]: item["remedy"] for item in items}
    assert [lines.count(remedies[name]) for name in PARTS] == [1] * len(PARTS), said
    assert said.count("CMake Error") == 1


def test_what_the_target_needs_besides_the_sdk_is_said_at_once(tmp_path: Path) -> None:
    skip_unless_buildable("bare_metal")
    two = target("freertos", XRCE) + target("bare_metal", XRCE).replace("(jiwy", "(other")
    arguments = [f"-DPICO_SDK_PATH={pico_sdk()}", "-DFETCHCONTENT_FULLY_DISCONNECTED=ON", *picotool()]
    said = configure(tmp_path, SDK + two + EXECUTABLE, *arguments, bare=True)
    for part in ("FreeRTOS kernel", "Micro-CDR", "Micro XRCE-DDS client"):
        assert said.count(f"{part} was not found. Get it: git clone") == 1, said
    assert said.count("CMake Error") == 1


def test_picotool_is_built_with_the_sdk_that_is_there(tmp_path: Path) -> None:
    """The build of picotool needs the SDK, and stops without it."""
    skip_if_missing(arm_gcc, pico_sdk)
    arguments = [f"-DPICO_SDK_PATH={pico_sdk()}", "-DFETCHCONTENT_FULLY_DISCONNECTED=ON"]
    assert f" -DPICO_SDK_PATH={pico_sdk()} " in configure(tmp_path, SDK, *arguments, bare=True)


def test_no_compiler(tmp_path: Path) -> None:
    skip_if_missing(pico_sdk)
    path = tmp_path / "bin"
    path.mkdir()
    for program in ("cmake", "ninja"):
        (path / program).symlink_to(shutil.which(program) or "")
    arguments = [f"-DPICO_SDK_PATH={pico_sdk()}", "-DCMAKE_FIND_USE_CMAKE_SYSTEM_PATH=FALSE"]
    said = configure(tmp_path, SDK, *arguments, bare=True, PATH=str(path))
    assert "Arm GNU toolchain was not found. Get it: " in said


def test_another_board(tmp_path: Path) -> None:
    skip_unless_buildable("bare_metal")
    said = configure(tmp_path, SDK + target(), "-DPICO_BOARD=pico2")
    assert "epg_add_target(jiwy): its target is for the board 'pico', and PICO_BOARD is 'pico2'" in said
    assert "-DPICO_BOARD=pico" in said
    assert "docs/adding-a-board.md says how to describe another one" in said


def test_no_kernel(tmp_path: Path) -> None:
    skip_unless_buildable("bare_metal")
    said = configure(
        tmp_path, SDK + target("freertos") + EXECUTABLE, f"-DPICO_SDK_PATH={pico_sdk()}", *picotool(), bare=True
    )
    assert "epg_add_target(jiwy): this computer lacks tools that the target needs." in said
    assert "FreeRTOS kernel was not found. Get it: git clone" in said
    assert said.count("CMake Error") == 1


def test_a_kernel_without_the_port_for_the_chip(tmp_path: Path) -> None:
    skip_unless_buildable("freertos")
    kernel = tmp_path / "kernel"
    (kernel / "include").mkdir(parents=True)
    for name in ("FreeRTOS.h", "task.h"):
        (kernel / "include" / name).write_bytes((freertos_kernel() / "include" / name).read_bytes())
    said = configure(tmp_path, SDK + target("freertos"), FREERTOS_KERNEL_PATH=str(kernel))
    assert "has no port for this chip" in said
    assert "submodule update --init" in said


def test_no_picotool_and_no_network(tmp_path: Path) -> None:
    skip_unless_buildable("bare_metal")
    arguments = [f"-DPICO_SDK_PATH={pico_sdk()}", "-DFETCHCONTENT_FULLY_DISCONNECTED=ON"]
    said = configure(tmp_path, SDK + target() + EXECUTABLE, *arguments, bare=True)
    assert "picotool was not found (without one the Pico SDK" in said
    assert "-DPICO_NO_PICOTOOL=1" in said


def test_without_picotool_by_choice(tmp_path: Path) -> None:
    skip_unless_buildable("bare_metal")
    arguments = [f"-DPICO_SDK_PATH={pico_sdk()}", "-DFETCHCONTENT_FULLY_DISCONNECTED=ON", "-DPICO_NO_PICOTOOL=1"]
    assert "CMake Error" not in configure(tmp_path, SDK + target() + EXECUTABLE, *arguments, bare=True)


def test_two_owners_of_usb(tmp_path: Path) -> None:
    skip_unless_buildable("bare_metal")
    (tmp_path / "main.c").write_text("int main(void) { return 0; }\n")
    user = "add_executable(user main.c)\ntarget_link_libraries(user EPG::jiwy pico_stdlib)\n"
    user += "pico_enable_stdio_usb(user 1)\n"
    said = configure(tmp_path, SDK + target(communication=CONSOLE) + user)
    assert "user links EPG::jiwy, whose transport is USB, and the Pico SDK's stdio over USB" in said
    assert "pico_enable_stdio_usb(user 0)" in said
    fine = configure(tmp_path, SDK + target(communication=CONSOLE) + user.replace("usb(user 1)", "usb(user 0)"))
    assert "CMake Error" not in fine


ONLY_IN_THE_SYSROOT = 'Could not find a package configuration file provided by "EPG"'
"""CMake's message under the SDK's toolchain.  CMake does not reach EPG, so EPG's pages must give the remedy."""


def test_the_package_under_the_sdks_toolchain(tmp_path: Path) -> None:
    skip_unless_buildable("bare_metal")
    for page in ("cmake.md", "pico.md"):
        assert ONLY_IN_THE_SYSROOT in (ROOT / "docs" / page).read_text(encoding="utf-8")
    line = "find_package(EPG REQUIRED NO_CMAKE_FIND_ROOT_PATH)"
    assert f"\n{line} " in (ROOT / "docs/cmake.md").read_text(encoding="utf-8")
    here = f"-DCMAKE_PREFIX_PATH={ROOT}"
    assert ONLY_IN_THE_SYSROOT in configure_package(tmp_path / "alone", "find_package(EPG REQUIRED)", here)
    assert "EPG has epg_add_target" in configure_package(tmp_path / "word", line, here)
    assert "EPG has epg_add_target" in configure_package(
        tmp_path / "variable", "find_package(EPG REQUIRED)", f"-DEPG_DIR={ROOT / 'cmake'}"
    )


def configure_package(folder: Path, find: str, option: str) -> str:
    """CMake's output for a project that finds EPG by ``find``, after project() and under the SDK's toolchain."""
    folder.mkdir()
    (folder / "CMakeLists.txt").write_text(
        f"cmake_minimum_required(VERSION 3.22)\ninclude({pico_sdk()}/external/pico_sdk_import.cmake)\n"
        f"project(firmware C CXX ASM)\n{find}\nif(COMMAND epg_add_target)\n"
        '  message(STATUS "EPG has epg_add_target")\nendif()\n',
        encoding="utf-8",
    )
    command = ["cmake", "-S", str(folder), "-B", str(folder / "build"), "-G", "Ninja", option]
    command += [f"-DPICO_SDK_PATH={pico_sdk()}"]
    done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    return " ".join(done.stdout.split())


USER = "add_executable(user main.c)\ntarget_link_libraries(user EPG::jiwy pico_stdlib{more})\n"


@pytest.mark.parametrize(
    ("project", "option", "said"),
    [
        (USER.format(more=""), "-DPICO_STDIO_USB=1", "stdio over USB, by PICO_STDIO_USB; there is one USB device"),
        (USER.format(more=" pico_stdio_usb"), "", "and pico_stdio_usb; there is one USB device. Take"),
        (
            USER.format(more="") + "target_compile_definitions(user PRIVATE PICO_NO_RAM_VECTOR_TABLE=1)\n",
            "",
            "Take PICO_NO_RAM_VECTOR_TABLE out of the compile definitions of user.",
        ),
        (
            EXECUTABLE + "pico_set_binary_type(jiwy_firmware copied)\n",
            "",
            "which cannot run in an executable of the type 'copied'. Write pico_set_binary_type(jiwy_firmware default)",
        ),
    ],
)
def test_settings_that_a_target_cannot_run_with(project: str, option: str, said: str, tmp_path: Path) -> None:
    skip_unless_buildable("bare_metal")
    (tmp_path / "main.c").write_text("int main(void) { return 0; }\n")
    options = [option] if option else []
    assert said in configure(tmp_path, SDK + target(communication=CONSOLE) + project, *options)
    if option:
        mended = project + "pico_enable_stdio_usb(user 0)\n"
        assert "CMake Error" not in configure(tmp_path, SDK + target(communication=CONSOLE) + mended, *options)


def picotool() -> list[str]:
    skip_if_missing(lambda: tool("picotool"))
    return [f"-Dpicotool_DIR={tool('picotool')}"]
