# SPDX-License-Identifier: Apache-2.0
"""Projects that ``epg new`` has written for boards, built with the Pico SDK or with the headers of ST and Arm."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from tests.doubles.toolchain import arm_gcc, pico_sdk, skip_if_missing, tool
from tests.examples.pico_project import (
    configure,
    environment,
    freertos_kernel,
    run,
    sdk_of_new_projects,
    skip_unless_buildable,
)
from tests.examples.test_new_projects import new, readme_commands


@pytest.mark.parametrize(("target", "board"), [("rpi_pico_bare_metal", "pico"), ("rpi_pico2_freertos_jiwy", "pico2")])
def test_a_project_for_a_board(target: str, board: str, tmp_path: Path) -> None:
    skip_unless_buildable(sdk_of_new_projects, freertos_kernel)
    project = new(tmp_path / "my robot", target)
    assert readme_commands(project, "cmake ")[:2] == ["cmake -B build", "cmake --build build"]
    output = configure(project) + run(project, "cmake", "--build", "build")
    assert f"PICO_BOARD:STRING={board}\n" in (project / "build/CMakeCache.txt").read_text(encoding="utf-8")
    warned = re.findall(r"^(\S+?):\d+:\d+: warning: ", output, re.MULTILINE)
    assert [file for file in warned if not file.startswith(str(pico_sdk()))] == []
    for suffix in ("uf2", "elf", "elf.map"):
        assert (project / f"build/robot_firmware.{suffix}").stat().st_size > 10_000
    assert "ninja: no work to do" in run(project, "cmake", "--build", "build")


CMSIS = ("cmsis_device_h7", "cmsis_core")


def cmsis_headers() -> tuple[Path, Path]:
    """The headers of ST and of Arm."""
    return tool("cmsis_device_h7"), tool("cmsis_core")


@pytest.mark.parametrize("target", ["nucleo_h743zi_bare_metal", "nucleo_h743zi2_freertos_jiwy"])
def test_a_project_for_a_nucleo(target: str, tmp_path: Path) -> None:
    skip_if_missing(arm_gcc, cmsis_headers, freertos_kernel)
    project = new(tmp_path / "my robot", target)
    assert readme_commands(project, "cmake ")[:2] == ["cmake -B build", "cmake --build build"]
    output = configure(project) + run(project, "cmake", "--build", "build")
    assert re.findall(r"warning", output, re.IGNORECASE) == []
    for suffix in ("bin", "elf", "elf.map"):
        assert (project / f"build/robot_firmware.{suffix}").stat().st_size > 10_000
    assert "ninja: no work to do" in run(project, "cmake", "--build", "build")


@pytest.mark.parametrize(
    ("there", "transport", "missing"),
    [((), "stlink", {"cmsis-device-h7-1.10.7", "CMSIS_5-5.9.0"}), (CMSIS, "usb", {"tinyusb-0.20.0"})],
)
def test_missing_parts_of_a_nucleo_are_named_together(
    there: tuple[str, ...], transport: str, missing: set[str], tmp_path: Path
) -> None:
    """A cache with everything but the headers, or but TinyUSB: the message has the command for each."""
    skip_if_missing(arm_gcc, cmsis_headers, freertos_kernel)
    cache = tmp_path / "cache"
    cache.mkdir()
    for name in ("freertos_kernel", "micro_cdr", "micro_xrce_dds_client", *there):
        folder = tool(name)
        (cache / folder.name).symlink_to(folder)
    project = new(tmp_path / "my robot", "nucleo_h743zi_freertos")
    file = project / "robot.tcf"
    file.write_text(file.read_text(encoding="utf-8").replace("transport: stlink", f"transport: {transport}"))
    output = configure(project, check=False, env=environment(EPG_CACHE=str(cache)))
    commands = re.findall(r"^ +(git clone .+)$", output, re.MULTILINE)
    assert {command.rpartition("/")[2] for command in commands} == missing
