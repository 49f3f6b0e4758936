# SPDX-License-Identifier: Apache-2.0
"""Projects that ``epg new`` has written for boards, built with the Pico SDK."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from tests.emulator.toolchain import pico_sdk
from tests.examples.pico_project import configure, freertos_kernel, run, sdk_of_new_projects, skip_unless_buildable
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
