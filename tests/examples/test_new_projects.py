# SPDX-License-Identifier: Apache-2.0
"""Projects of ``epg new``, which the tests configure, build and run as their users do."""

from __future__ import annotations

import csv
import re
import shutil
from pathlib import Path

import pytest

import epg
from epg.cli.main import main
from tests.examples.pico_project import (
    ROOT,
    configure,
    run,
)

JIWY = ROOT / "examples/jiwy/model"


def new(folder: Path, target: str, model: Path = JIWY, name: str = "robot") -> Path:
    assert main(["new", str(folder), "--target", target, "--model", str(model), "--name", name]) == 0
    return folder


def readme_commands(project: Path, beginning: str) -> list[str]:
    """The README's commands that begin with this text."""
    readme = (project / "README.md").read_text(encoding="utf-8")
    return re.findall(rf"^({re.escape(beginning)}.*)$", readme, re.MULTILINE)


def simulate(project: Path, command: str) -> list[dict[str, str]]:
    """The trace of the README's first run."""
    assert command.endswith("--trace trace.csv")
    assert "enabled, faults 0" in run(project, "sh", "-c", command)
    with (project / "trace.csv").open(newline="") as file:
        return list(csv.DictReader(file))


def assert_it_moves(project: Path, build: str, target: str) -> None:
    """The README's simulation; for JIWY, also that an axis follows its setpoint."""
    (command,) = readme_commands(project, f"cmake --build {build} --target")
    assert "FAILED" not in run(project, "sh", "-c", command)
    with (project / build / "tracking.csv").open(newline="") as file:
        *_, last = csv.DictReader(file)
    if "jiwy" in target:
        for axis in ("pan", "tilt"):
            assert float(last[f"{axis}_subscriber_setpoint"]) == 0.3
            assert abs(float(last[f"{axis}_subscriber_position"]) - 0.3) < 0.02
    else:
        assert 0.3 in [float(value) for name, value in last.items() if name.endswith("_position")]


def talk(project: Path, command: str) -> str:
    """The output of the console in the README's second run."""
    assert command.endswith("--realtime --console")
    answers = run(project, "sh", "-c", f"printf 'stats\\nenable\\nports\\n' | {command}")
    assert "stat enabled=0" in answers, "nothing moves until somebody enables"
    assert "ok enable" in answers
    return answers


@pytest.mark.parametrize(
    ("target", "model", "port"),
    [("host_jiwy", JIWY, "setpoint_pan"), ("host", ROOT / "examples/relbot/model", "SetPosLeft")],
)
def test_a_project_for_the_host(target: str, model: Path, port: str, tmp_path: Path) -> None:
    project = new(tmp_path / "my robot", target, model)
    configure(project)
    run(project, "cmake", "--build", "build")
    assert_it_moves(project, "build", target)
    first, second = readme_commands(project, "build/robot_host")
    rows = simulate(project, first)
    assert len(rows) == 5 / (float(rows[1]["time"]) - float(rows[0]["time"]))
    assert float(rows[-1][f"inputs.{port}"]) == 0.1
    talk(project, second)


def test_a_project_for_any_firmware(tmp_path: Path) -> None:
    """It builds with EPG's stubs, and then with drivers of its own: a copy of the stubs of another robot."""
    project = new(tmp_path / "my robot", "firmware", ROOT / "examples/existing_firmware/station/model")
    assert "There are no drivers yet" in configure(project)
    run(project, "cmake", "--build", "build")
    assert (project / "build/robot_firmware").is_file()
    file = project / "robot.tcf"
    text = file.read_text(encoding="utf-8").replace("  # motor: {", "  motor: {").replace("# clocks: {", "clocks: {")
    file.write_text(text, encoding="utf-8")
    file = project / "robot.bindings.yaml"
    file.write_text(file.read_text(encoding="utf-8").replace("duty: duty", "duty: motor"), encoding="utf-8")
    (project / "src/robot_drivers.c").write_text("", encoding="utf-8")
    assert "There are no drivers yet" not in configure(project)
    stubs = (project / "build/epg/robot/robot_drivers.stub").read_text(encoding="utf-8")
    assert "void robot_motor_write(uint32_t level)" in stubs
    (project / "src/robot_drivers.c").write_text(stubs, encoding="utf-8")
    run(project, "cmake", "--build", "build")
    assert "#define ROBOT_MOTOR_TOP 4999U" in (project / "build/epg/robot/robot_firmware.h").read_text(encoding="utf-8")


@pytest.mark.parametrize("target", ["rpi_pico2_freertos_jiwy", "rpi_pico_bare_metal", "firmware"])
def test_the_simulation_of_a_project_for_a_board(target: str, tmp_path: Path) -> None:
    project = new(tmp_path / "my robot", target)
    configure(project / "simulation")
    run(project, "cmake", "--build", "simulation/build")
    assert_it_moves(project, "simulation/build", target)
    first, second = readme_commands(project, "simulation/build/robot_host")
    assert float(simulate(project, first)[-1]["inputs.setpoint_pan"]) == 0.1
    talk(project, second)
    assert not re.search(r"^ *MODEL .*build", (project / "simulation/CMakeLists.txt").read_text(), re.M)


# missing tools --------------------------------------------------------------------------------------------------------


def fake_sdk(home: Path, version: str) -> Path:
    folder = home / ".pico-sdk/sdk" / version
    folder.mkdir(parents=True)
    (folder / "pico_sdk_init.cmake").write_text('message(STATUS "the SDK was taken")\n')
    names = zip(("MAJOR", "MINOR", "REVISION"), version.split("."))
    (folder / "pico_sdk_version.cmake").write_text("".join(f"set(PICO_SDK_VERSION_{n} {v})\n" for n, v in names))
    return folder


def fake_compiler(home: Path, version: str = "14_2_Rel1") -> Path:
    folder = home / ".pico-sdk/toolchain" / version
    (folder / "bin").mkdir(parents=True)
    (folder / "bin/arm-none-eabi-gcc").touch(0o755)
    return folder


class User:
    """A user with a new project, a home folder, and the tools that the test puts into it."""

    def __init__(self, folder: Path, target: str) -> None:
        self.home = folder / "home"
        self.home.mkdir()
        self.project = new(folder / "robot", target)

    def configure(self, *options: str, check: bool = False, **variables: str) -> str:
        from tests.examples.pico_project import environment

        env = environment(HOME=str(self.home), XDG_CACHE_HOME=None, EPG_CACHE=None)
        output = configure(self.project, *options, check=check, env={**env, **variables})
        return " ".join(output.split())


@pytest.fixture
def user(tmp_path: Path) -> User:
    return User(tmp_path, "rpi_pico2_freertos_jiwy")


def errors(output: str) -> int:
    return output.count("CMake Error")


def test_another_sdk(user: User) -> None:
    """The installed SDK has another version than the project needs: the message gives both solutions."""
    folder = fake_sdk(user.home, "2.1.1")
    output = user.configure()
    assert (
        "This project is written for version 2.2.0 of the Raspberry Pi Pico SDK, but the one in"
        f" {folder} is 2.1.1. Get it: git clone --depth 1 --branch 2.2.0 "
    ) in output
    assert "Or write 2.1.1 in place of 2.2.0 in CMakeLists.txt." in output
    assert errors(output) == 1
    for options, variables in (([f"-DPICO_SDK_PATH={folder}"], {}), ([], {"PICO_SDK_PATH": str(folder)})):
        shutil.rmtree(user.project / "build")
        output = user.configure(*options, **variables)
        assert (
            f"This project is written for version 2.2.0 of the Raspberry Pi Pico SDK, but the one in {folder}" in output
        )


def test_of_several_sdks_the_projects_is_taken(user: User) -> None:
    for version in ("2.1.1", "2.2.0", "2.3.0"):
        fake_sdk(user.home, version)
    wanted = user.home / ".pico-sdk/sdk/2.2.0"
    (wanted / "pico_sdk_init.cmake").write_text(
        'message(FATAL_ERROR "taken: ${PICO_SDK_PATH} ${PICO_TOOLCHAIN_PATH}")\n'
    )
    fake_compiler(user.home, "15_2_Rel1")
    compiler = fake_compiler(user.home)
    assert f"taken: {wanted} {compiler}" in user.configure()


def test_the_vs_code_extensions_file_is_heeded(user: User) -> None:
    """It names the folders that the extension fills; the message says if one of them is still missing."""
    extension = user.home / ".pico-sdk/cmake/pico-vscode.cmake"
    extension.parent.mkdir(parents=True)
    extension.write_text('set(PICO_SDK_PATH "${USERHOME}/.pico-sdk/sdk/${sdkVersion}")\n')
    fake_compiler(user.home)
    assert f"there is no {user.home}/.pico-sdk/sdk/2.2.0/pico_sdk_init.cmake. Get it: git clone" in user.configure()
    (fake_sdk(user.home, "2.2.0") / "pico_sdk_init.cmake").write_text(
        'message(FATAL_ERROR "taken: ${PICO_SDK_PATH}")\n'
    )
    assert f"taken: {user.home}/.pico-sdk/sdk/2.2.0" in user.configure()


def test_another_kernel(user: User) -> None:
    kernel = user.home / ".cache/epg/FreeRTOS-Kernel-10.6.2"
    (kernel / "include").mkdir(parents=True)
    (kernel / "include/FreeRTOS.h").touch()
    (kernel / "include/task.h").write_text('#define tskKERNEL_VERSION_NUMBER       "V10.6.2"\n')
    fake_sdk(user.home, "2.2.0")
    output = user.configure()
    assert f"version 11.3.0 of the FreeRTOS kernel, but the one in {kernel} is 10.6.2. Get it: git clone" in output
    assert errors(output) == 1


@pytest.mark.parametrize("target", ["host", "rpi_pico_bare_metal"])
def test_another_epg(target: str, tmp_path: Path) -> None:
    project = new(tmp_path / "robot", target)
    file = project / "CMakeLists.txt"
    file.write_text(file.read_text().replace(f"set(epgVersion {epg.__version__})", "set(epgVersion 9.8.7)"))
    output = " ".join(configure(project, check=False).split())
    assert f"This project is written for EPG 9.8.7, but the EPG in {ROOT}/cmake is {epg.__version__}. " in output
    assert "Install EPG 9.8.7 from its folder (docs/installing.md), or name that folder: -DEPG_PATH=" in output
    assert errors(output) == 1
