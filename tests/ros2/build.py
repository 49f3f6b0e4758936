# SPDX-License-Identifier: Apache-2.0
"""Builds the robots of ``robots/CMakeLists.txt`` as a user does."""

from __future__ import annotations

import shutil
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

from tests.emulator.toolchain import Missing, tool

HERE = Path(__file__).resolve().parent

Build = Callable[[str], Path]
"""``build("follower")``: the host executable of a target."""


def build_robots(folder: Path, flags: str) -> Build:
    """Configures once; a target is built when it is first requested.  Raises Missing."""
    tool("cyclonedds")
    for program, package in (("cmake", "cmake"), ("ninja", "ninja-build")):
        if not shutil.which(program):
            raise Missing(f"{program} is missing: apt install {package}")
    options = [f"-DPython3_EXECUTABLE={sys.executable}", f"-DCMAKE_C_FLAGS={flags}", f"-DCMAKE_CXX_FLAGS={flags}"]
    _run("cmake", "-S", str(HERE / "robots"), "-B", str(folder), "-G", "Ninja", *options)

    def build(target: str) -> Path:
        _run("cmake", "--build", str(folder), "--target", f"{target}_host")
        return folder / f"{target}_host"

    return build


def _run(*command: str) -> None:
    done = subprocess.run(command, capture_output=True, text=True, check=False, timeout=600)
    assert done.returncode == 0, done.stdout + done.stderr
