# SPDX-License-Identifier: Apache-2.0
"""Projects that tests build once, with CMake and Ninja.

>>> # built(HERE / "robot", folder, "-DCMAKE_C_FLAGS=-O1", targets=["robot_host"]) / "robot_host"
"""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path

from tests.doubles.toolchain import cmake_and_ninja, skip_if_missing

SANITIZERS = "-O1 -g -fsanitize=address,undefined -fno-sanitize-recover=all"
"""Options of the compiler."""


def configured(project: Path, folder: Path, *options: str) -> Path:
    """Configures a project with EPG of these tests; returns ``folder``.  Raises :class:`Missing`."""
    cmake_and_ninja()
    python = f"-DPython3_EXECUTABLE={sys.executable}"
    _run("cmake", "-S", str(project), "-B", str(folder), "-G", "Ninja", python, *options)
    return folder


def built(project: Path, folder: Path, *options: str, targets: Sequence[str] = ()) -> Path:
    """Configures and builds a project, or only ``targets``; returns ``folder``.  Skips the test without CMake."""
    skip_if_missing(cmake_and_ninja)
    configured(project, folder, *options)
    build(folder, *targets)
    return folder


def build(folder: Path, *targets: str) -> None:
    """Builds all targets of a configured folder, or only ``targets``."""
    _run("cmake", "--build", str(folder), *(("--target", *targets) if targets else ()))


def _run(*command: str) -> None:
    done = subprocess.run(command, capture_output=True, text=True, check=False, timeout=600)
    assert done.returncode == 0, done.stdout + done.stderr
