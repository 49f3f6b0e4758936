# SPDX-License-Identifier: Apache-2.0
"""Checks that generated C compiles under the strictest warnings that EPG promises."""

from __future__ import annotations

import re
import shutil
import subprocess
import tempfile
from collections.abc import Mapping
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parent.parent.parent
STRICT = ["-std=c11", "-Wall", "-Wextra", "-Wconversion", "-Wdouble-promotion", "-Werror"]
needs_compiler = pytest.mark.skipif(shutil.which("gcc") is None, reason="gcc is not installed: sudo apt install gcc")


def include_options(cmake: str) -> list[str]:
    """The folders of the headers that ``<name>.cmake`` lists; a copy in a user's ``targets`` counts as EPG's own."""
    headers = re.findall(r'"\$\{(?:EPG_TARGETS_DIR|CMAKE_SOURCE_DIR\}/targets)\}?/([^"]+\.h)"', cmake)
    inside = sorted({str(Path(header).parent) for header in headers})
    return [f"-I{ROOT / 'targets' / folder}" for folder in ("runtime/include", "platforms/host/include", *inside)]


def compile_outputs(name: str, files: Mapping[str, str]) -> None:
    """Asserts that every generated C file of target ``name`` compiles, except the model's own code."""
    with tempfile.TemporaryDirectory() as made:
        folder = Path(made)
        for file, text in files.items():
            (folder / file).parent.mkdir(parents=True, exist_ok=True)
            (folder / file).write_text(text, encoding="utf-8")
        sources = [file for file in sorted(files) if file.endswith(".c") and is_strict(file)]
        assert sources
        command = [
            "gcc",
            "-fsyntax-only",
            *STRICT,
            *include_options(files.get(f"{name}.cmake", "")),
            f"-I{folder}",
            *sources,
        ]
        done = subprocess.run(command, cwd=folder, capture_output=True, text=True, errors="replace")
        assert done.returncode == 0, done.stderr[:4000]


def is_strict(file: str) -> bool:
    """True if a generated file is compiled with the project's warnings: all files except the model's own code."""
    return not file.endswith("_export.c") and "_copies/" not in file
