# SPDX-License-Identifier: Apache-2.0
"""The benchmark of Zephyr runs with one board and one round: both applications make the same image."""

from __future__ import annotations

import re
import subprocess
import sys
from functools import partial

from tests.doubles.toolchain import ROOT, arm_gcc, node, rp2040js, skip_if_missing, tool
from tests.zephyr.workspace import c_library, workspace


def test_it_runs_and_prints_its_tables() -> None:
    boards = ("rpi_pico", "nucleo_h743zi", "rpi_pico2/rp2350a/m33")
    skip_if_missing(arm_gcc, partial(workspace, *boards), c_library, lambda: tool("micro_xrce_dds_client"))
    command = [sys.executable, str(ROOT / "benchmarks/zephyr.py"), "--rounds", "1", "--boards", "1"]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    titles = re.findall(r"^(.+)\n-+$", done.stdout, flags=re.MULTILINE)
    assert titles == ["Configuring JIWY (cmake), processor time", "Size of images, bytes"]


def test_timing_runs_and_prints_what_the_page_shows() -> None:
    skip_if_missing(arm_gcc, partial(workspace, "rpi_pico"), c_library, node, rp2040js)
    skip_if_missing(lambda: tool("micro_xrce_dds_client"))
    command = [sys.executable, str(ROOT / "benchmarks/zephyr_timing.py"), "--seeds", "1", "--milliseconds", "100"]
    done = subprocess.run([*command, "--loads", "1", "--cycles", "20"], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    titles = re.findall(r"^(.+)\n-+$", done.stdout, flags=re.MULTILINE)
    page = (ROOT / "docs" / "benchmarks.md").read_text(encoding="utf-8")
    section = re.search(r"<!-- begin zephyr_timing -->(.*?)<!-- end zephyr_timing -->", page, re.S)
    assert section is not None
    assert titles == re.findall(r"^### (.+)$", section[1], flags=re.MULTILINE)
