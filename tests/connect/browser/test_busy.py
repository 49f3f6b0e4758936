# SPDX-License-Identifier: Apache-2.0
"""A robot stays enabled from the page while it draws 12 plots, and other programs use all of the computer.

The line is a UDP port on this computer.  A thread of Linux carries the bytes of a terminal, as it does those of a USB
port; beside so many busy processes, it has waited up to a second for a processor.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

from tests.live.witness import PROJECT, Robot, build_robot

from .acts import let_pass
from .served import ROOT, Served

UNITS = ("rad", "m", "V", "A", "N", "s", "K", "Hz", "Pa", "kg", "W")
SECONDS = 60
BUSY = 6 * max(1, (os.cpu_count() or 1) // 2)
"""Busy processes: six on a computer with two processors."""


def project_with_units(folder: Path) -> Path:
    """The robot with signals of 11 units; with the times of the loop, these are 12 plots."""
    shutil.copytree(PROJECT, folder)
    for name, old, new in (
        ("CMakeLists.txt", "${CMAKE_CURRENT_SOURCE_DIR}/../../..", ROOT.as_posix()),
        *(("model/model.yaml", f"wave_{number}: {{}}", f"wave_{number}: {{unit: {unit}}}")
          for number, unit in enumerate(UNITS[:9], start=1)),
        ("model/model.yaml", "in_8: {}", f"in_8: {{unit: {UNITS[9]}}}"),
        ("model/model.yaml", "in_9: {}", f"in_9: {{unit: {UNITS[10]}}}"),
    ):  # fmt: skip
        text = (folder / name).read_text(encoding="utf-8")
        assert old in text
        (folder / name).write_text(text.replace(old, new), encoding="utf-8")
    return folder


@pytest.fixture
def busy() -> Iterator[Callable[[], None]]:
    processes: list[subprocess.Popen[bytes]] = []

    def start() -> None:
        processes.extend(subprocess.Popen([sys.executable, "-c", "while True: pass"]) for _ in range(BUSY))

    yield start
    for process in processes:
        process.kill()
        process.wait()


def test_a_robot_stays_enabled(tmp_path: Path, open_page: Callable[..., Any], busy: Callable[[], None]) -> None:
    project = project_with_units(tmp_path / "project")
    with Robot(build_robot(tmp_path / "build", project), tmp_path, udp=True) as robot, Served(project) as epg:
        epg.post("live/connect", path=str(robot.port))
        page = open_page(epg.address)
        page.get_by_role("tab", name="Live").click()
        page.get_by_role("button", name="Larger").click()
        for box in page.locator(".live-signals input").all():
            box.check()
        let_pass(page.evaluate, 10.0)  # the plots are full
        assert page.locator(".plots canvas").count() == 13, "one for each unit, one without, one of the loop"
        busy()
        page.get_by_role("button", name="Enable (hold)").click(delay=700, timeout=60_000)
        robot.wait(driven=True)
        for second in range(SECONDS):
            let_pass(page.evaluate, 1.0)
            if not robot.is_driven():
                let_pass(page.evaluate, 1.0)  # until all has arrived that shows who was late
                pytest.fail(f"after {second} s: {epg.state()['live']['target']['fault']}")
        page.keyboard.press("Space")
        robot.wait(driven=False)
        assert epg.state()["live"]["target"]["state"]["fault"] == "none"
