# SPDX-License-Identifier: Apache-2.0
"""JIWY's target on a Cortex-M3 that QEMU emulates, with emulated peripherals."""

from __future__ import annotations

import re
import shutil
import subprocess
import threading
from pathlib import Path

from tests.doubles.toolchain import ROOT, Missing, arm_gcc, skip_if_missing

from .workspace import build, c_library, workspace

BOARD = "mps2/an385"
PATIENCE = 120.0
"""Limit in seconds for 3 simulated seconds, on a machine that also runs other programs."""

END = re.compile(r"PROJECT EXECUTION (\w+)")


def qemu() -> str:
    program = shutil.which("qemu-system-arm")
    if program is None:
        raise Missing("qemu-system-arm is not installed: sudo apt install qemu-system-arm")
    return program


def console_of(image: Path) -> str:
    """The image's output up to the end of its tests.  Instructions determine the time, so that load has no effect."""
    command = [qemu(), "-machine", "mps2-an385", "-nographic", "-vga", "none", "-nic", "none", "-kernel", str(image)]
    command += ["-icount", "shift=4,align=off,sleep=off", "-rtc", "clock=vm"]
    lines: list[str] = []
    with subprocess.Popen(
        command, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True
    ) as process:
        assert process.stdout is not None
        timer = threading.Timer(PATIENCE, process.kill)
        timer.start()
        for line in process.stdout:
            lines.append(line)
            if END.search(line):
                break
        timer.cancel()
        process.kill()
    return "".join(lines)


def test_jiwy_in_qemu() -> None:
    """Cycles are counted and do not overrun; the emulated encoder is read; outputs, faults, stop and start work."""
    skip_if_missing(lambda: workspace(BOARD), arm_gcc, c_library, qemu)
    said = console_of(build("tests/zephyr/jiwy", BOARD, settings=c_library()) / "zephyr" / "zephyr.elf")
    end = END.search(said)
    assert end is not None and end[1] == "SUCCESSFUL", said
    passed = set(re.findall(r"PASS - \[jiwy(?:_refused)?\.(\w+)\]", said))
    tests = re.findall(r"^ZTEST\(\w+, (\w+)\)", (ROOT / "tests/zephyr/jiwy/src/main.c").read_text(), re.MULTILINE)
    assert "test_stop_and_start" in tests
    assert passed == set(tests), said
