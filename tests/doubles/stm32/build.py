# SPDX-License-Identifier: Apache-2.0
"""Compiles the small programs of ``programs`` for the emulated STM32H743, against the headers of ST and Arm.

>>> # elf = small("first")
"""

from __future__ import annotations

import hashlib
import subprocess
from functools import lru_cache
from pathlib import Path

from epg.generator.bootstrap import cache_folder
from tests.doubles.toolchain import arm_gcc, locked, skip_if_missing, tool, unicorn

PROGRAMS = Path(__file__).resolve().parent / "programs"
OPTIONS = ("-mcpu=cortex-m7", "-mthumb", "-mfpu=fpv5-d16", "-mfloat-abi=hard", "-std=gnu11", "-O2", "-g")
WARNINGS = ("-Wall", "-Wextra", "-Wconversion", "-Wdouble-promotion", "-Werror")


@lru_cache
def small(name: str, *, mps2: Path | None = None) -> Path:
    """The program ``name``.c with its start, built once per version of its sources; skips without the tools.

    With ``mps2``, a linker script, it is for Arm's MPS2 board in QEMU, where it has the core's registers only.
    """
    skip_if_missing(arm_gcc, unicorn, lambda: tool("cmsis_core"), lambda: tool("cmsis_device_h7"))
    script = mps2 or PROGRAMS / "small.ld"
    sources = [PROGRAMS / "start.c", PROGRAMS / f"{name}.c"]
    files = [*sources, PROGRAMS / "small.h", script]
    digest = hashlib.sha256(b"".join(file.read_bytes() for file in files)).hexdigest()[:16]
    output: Path = cache_folder() / "test-build" / f"stm32-{name}-{digest}.elf"
    with locked(output):
        if not output.is_file():
            output.parent.mkdir(parents=True, exist_ok=True)
            headers = (tool("cmsis_device_h7") / "Include", tool("cmsis_core") / "CMSIS" / "Core" / "Include")
            command = [str(arm_gcc()), *OPTIONS, *WARNINGS, "-DSTM32H743xx"]
            for folder in headers:
                command += ["-isystem", str(folder)]
            command += ["-DMPS2"] if mps2 else []
            command += ["-nostartfiles", "-specs=nosys.specs", "-T", str(script), *map(str, sources)]
            subprocess.run([*command, "-o", str(output)], check=True)
    return output
