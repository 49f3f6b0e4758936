# SPDX-License-Identifier: Apache-2.0
"""Compiles the motor of the host platform's own tests."""

from __future__ import annotations

import shutil
import subprocess
import sys
from pathlib import Path

from tests.platforms.host.program import PROGRAMS, include_folders, platform_sources


def compile_motor(output: Path, *defines: str) -> Path:
    """The motor of the host platform's own tests, compiled with ``defines``."""
    compiler = shutil.which("gcc") or shutil.which("cc")
    assert compiler is not None, "a C compiler is needed"
    sources = [*platform_sources(system="linux" if sys.platform == "linux" else "elsewhere"), PROGRAMS / "motor.c"]
    command = [compiler, "-std=c11", "-O1", "-DEPG_HOST_TARGET=epg_host_application"]
    command += [f"-D{define}" for define in defines]
    command += [f"-I{folder}" for folder in include_folders()]
    subprocess.run([*command, *map(str, sources), "-pthread", "-lm", "-o", str(output)], check=True)
    return output
