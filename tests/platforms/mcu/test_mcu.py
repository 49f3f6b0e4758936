# SPDX-License-Identifier: Apache-2.0
"""The code that all families share does not depend on a chip: it compiles for a fictitious family and runs here."""

from __future__ import annotations

import re
import subprocess
from pathlib import Path

import pytest

from tests.emulator.toolchain import ROOT, arm_gcc, skip_if_missing, tool
from tests.platforms.pico.compiled import STRICT
from tests.runtime.program import RUNTIME, compile_program, run_program

HERE = Path(__file__).resolve().parent
PLATFORMS = ROOT / "targets" / "platforms"
SHARED = [PLATFORMS / name for name in ("mcu", "bare_metal", "freertos")]
INCLUDES = [HERE / "family" / "include", PLATFORMS / "mcu" / "include", RUNTIME / "include"]
CORES = ["cortex-m0plus", "cortex-m33", "cortex-m4", "cortex-m7"]


def test_no_file_of_theirs_names_a_chip() -> None:
    files = [path for folder in SHARED for path in folder.rglob("*") if path.is_file()]
    assert len(files) > 12
    code = {path.name: re.sub(r"/\*.*?\*/", "", path.read_text(encoding="utf-8"), flags=re.DOTALL) for path in files}
    assert [name for name, text in code.items() if re.search("pico|rp2", text, re.IGNORECASE)] == []


@pytest.mark.parametrize("core", CORES)
def test_bare_metal_compiles_for_other_cores(core: str) -> None:
    skip_if_missing(arm_gcc)
    compile_only(core, [*(PLATFORMS / "mcu" / "src").glob("*.c"), *(PLATFORMS / "bare_metal" / "src").glob("*.c")])


def test_freertos_compiles_for_a_cortex_m7() -> None:
    skip_if_missing(arm_gcc, kernel)
    folders = [kernel() / "include", kernel() / "portable" / "GCC" / "ARM_CM7" / "r0p1"]
    folders += [PLATFORMS / "freertos" / "include", HERE / "family" / "freertos" / "include"]
    sources = [*(PLATFORMS / "mcu" / "src").glob("*.c"), *(PLATFORMS / "freertos" / "src").glob("*.c")]
    compile_only("cortex-m7", sources, *(f"-I{folder}" for folder in folders), "-mfpu=fpv5-d16", "-mfloat-abi=hard")


def test_the_store_and_the_ticks(tmp_path: Path) -> None:
    sources = [HERE / "store.c", PLATFORMS / "mcu" / "src" / "store.c"]
    done = run_program([compile_program(tmp_path / "store", sources, includes=INCLUDES)])
    assert done.returncode == 0, done.stdout + done.stderr


def kernel() -> Path:
    return tool("freertos_kernel")


def compile_only(core: str, sources: list[Path], *options: str) -> None:
    assert len(sources) >= 4
    for source in sources:
        command = [str(arm_gcc()), "-std=gnu11", f"-mcpu={core}", "-mthumb", "-O2", "-c", "-o", "/dev/null"]
        command += [*STRICT, *(f"-I{folder}" for folder in INCLUDES), *options, "-DEPG_MCU_START=robot_start"]
        done = subprocess.run([*command, str(source)], capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stderr
