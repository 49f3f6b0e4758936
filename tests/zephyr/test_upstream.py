# SPDX-License-Identifier: Apache-2.0
"""The patch to Zephyr's own decoder for STM32."""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path

import pytest

from tests.doubles.toolchain import ROOT, Missing, skip_if_missing, tool

PATCH = ROOT / "zephyr_module" / "upstream" / "st-stm32-qdec.patch"
MADE_FOR = "VERSION_MAJOR = 4\nVERSION_MINOR = 1\nPATCHLEVEL = 99\n"


def zephyr() -> Path:
    """The source tree for which the patch is made."""
    base = tool("zephyr")
    if not (base / "VERSION").read_text(encoding="utf-8").startswith(MADE_FOR):
        raise Missing("Zephyr is not 4.1.99, which the patch is made for")
    return base


def patch() -> str:
    program = shutil.which("patch")
    if program is None:
        raise Missing("patch is not installed: sudo apt install patch")
    return program


def test_it_applies() -> None:
    skip_if_missing(zephyr, patch)
    command = [patch(), "-p1", "--dry-run", "--fuzz=0", "-d", str(zephyr()), "-i", str(PATCH)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    assert done.stdout.count("checking file") == PATCH.read_text(encoding="utf-8").count("\n+++ ") == 7


def test_checkpatch() -> None:
    skip_if_missing(zephyr)
    program = shutil.which("perl")
    if program is None:
        pytest.skip("perl, which checkpatch needs, is not installed: sudo apt install perl")
    command = [program, str(zephyr() / "scripts" / "checkpatch.pl"), "--no-tree", "--no-signoff", "-q", str(PATCH)]
    done = subprocess.run(command, capture_output=True, text=True, check=False, cwd=zephyr())
    assert done.returncode == 0, done.stdout + done.stderr
