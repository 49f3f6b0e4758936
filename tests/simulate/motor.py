# SPDX-License-Identifier: Apache-2.0
"""Compiles the motor of the host platform's own tests."""

from __future__ import annotations

import shutil
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]


def compile_motor(output: Path, *defines: str) -> Path:
    """The motor of the host platform's own tests, compiled with ``defines``."""
    compiler = shutil.which("gcc") or shutil.which("cc")
    assert compiler is not None, "a C compiler is needed"
    host, runtime = ROOT / "targets" / "platforms" / "host", ROOT / "targets" / "runtime"
    folders = (
        runtime / "src/control",
        runtime / "src/communication",
        host / "src",
        host / "src" / ("linux" if sys.platform == "linux" else "elsewhere"),
    )
    sources = [source for folder in folders for source in sorted(folder.glob("*.c"))]
    sources.append(ROOT / "tests" / "platforms" / "host" / "programs" / "motor.c")
    command = [compiler, "-std=c11", "-O1", "-DEPG_HOST_TARGET=epg_host_application"]
    command += [f"-D{define}" for define in defines]
    command += [f"-I{folder}" for folder in (runtime / "include", host / "include", host / "src")]
    subprocess.run([*command, *map(str, sources), "-pthread", "-lm", "-o", str(output)], check=True)
    return output
