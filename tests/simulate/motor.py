# SPDX-License-Identifier: Apache-2.0
"""Compiles the motor of the host platform's own tests."""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path

from epg.generator.system import here
from tests.platforms.host.program import PROGRAMS, include_folders, platform_sources


def compile_motor(output: Path, *defines: str) -> Path:
    """The motor of the host platform's own tests, compiled with ``defines``."""
    compiler = shutil.which("gcc") or shutil.which("cc")
    assert compiler is not None, "a C compiler is needed"
    sources = [*platform_sources(system=here.NAME), PROGRAMS / "motor.c"]
    command = [compiler, "-std=c11", "-O1", "-DEPG_HOST_TARGET=epg_host_application", "-D_DARWIN_C_SOURCE"]
    command += [f"-D{define}" for define in defines]
    command += [f"-I{folder}" for folder in include_folders(here.NAME)]
    subprocess.run([*command, *map(str, sources), "-pthread", "-lm", "-o", str(output)], check=True)
    return output
