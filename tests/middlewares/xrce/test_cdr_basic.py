# SPDX-License-Identifier: Apache-2.0
"""The middleware's functions for numbers do the same as those of Micro-CDR that they replace."""

from __future__ import annotations

import subprocess
from pathlib import Path

from tests.doubles.toolchain import skip_if_missing, tool

ROOT = Path(__file__).resolve().parents[3]
PROGRAM = Path(__file__).resolve().parent / "cdr" / "trace.c"
CONFIG = """\
#define UCDR_VERSION_MAJOR 2
#define UCDR_MACHINE_ENDIANNESS UCDR_LITTLE_ENDIANNESS
"""


def trace(folder: Path, cdr: Path, numbers: Path) -> list[str]:
    """The lines that the program prints if it is linked with the source ``numbers``."""
    (folder / "ucdr").mkdir(parents=True)
    (folder / "ucdr" / "config.h").write_text(CONFIG)
    sources = [PROGRAM, cdr / "src" / "c" / "common.c", numbers]
    includes = [f"-I{each}" for each in (folder, cdr / "include", cdr / "src" / "c")]
    flags = ["-std=c11", "-O1", "-fsanitize=address,undefined", "-fno-sanitize-recover=all"]
    subprocess.run(["gcc", *flags, *includes, *sources, "-o", folder / "trace"], check=True)
    return subprocess.run([folder / "trace"], capture_output=True, text=True, check=True).stdout.splitlines()


def test_the_functions_for_numbers_are_those_of_micro_cdr(tmp_path: Path) -> None:
    skip_if_missing(lambda: tool("micro_cdr"))
    cdr = tool("micro_cdr")
    theirs = trace(tmp_path / "theirs", cdr, cdr / "src" / "c" / "types" / "basic.c")
    ours = trace(tmp_path / "ours", cdr, ROOT / "targets" / "middlewares" / "xrce" / "micro_cdr" / "basic.c")
    assert len(ours) > 10_000
    assert ours == theirs
