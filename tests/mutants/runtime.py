# SPDX-License-Identifier: Apache-2.0
"""The C tests of the runtime with one mutated source; all other objects are compiled once."""

from __future__ import annotations

import os
import shutil
import subprocess
from collections.abc import Sequence
from pathlib import Path

from tests.runtime.program import (
    ADDRESS_SANITIZER,
    COMPONENTS,
    RUNTIME,
    SOURCES,
    component_sources,
    names_in,
    runtime_sources,
)

from .mutant import Mutant
from .workshop import ROOT, run

COMPILER = shutil.which("gcc") or shutil.which("cc") or "cc"
FOLDERS = [
    RUNTIME / "include",
    RUNTIME / "src",
    SOURCES,
    *sorted(path for path in COMPONENTS.iterdir() if path.is_dir()),
]
OPTIONS = ["-std=c11", "-ffp-contract=off", "-pthread", "-w", *(f"-I{folder}" for folder in FOLDERS)]
LIMIT = 60
"""Seconds after which a C test counts as endless."""


class Objects:
    """The objects of the runtime, the drivers and the tests."""

    def __init__(self, folder: Path) -> None:
        folder.mkdir()
        helpers = [SOURCES / "fake_port.c", SOURCES / "fake_application.c", SOURCES / "motor.c"]
        self.programs = sorted(SOURCES.glob("*_tests.c"))
        self._folder = folder
        self._common = {
            source: self._compile(source) for source in [*runtime_sources(), *component_sources(), *helpers]
        }
        self._own = {source: self._compile(source) for source in self.programs}

    def _compile(self, source: Path) -> Path:
        output = self._folder / f"{source.parent.name}_{source.stem}.o"
        assert compile_object(source, output, ["-O1", *ADDRESS_SANITIZER]), source
        return output

    def catch(self, mutant: Mutant, folder: Path) -> bool:
        """True if a C test fails.  The tests that belong to the mutated file run first."""
        source = folder / Path(mutant.file).name
        source.write_text(mutant.text(), encoding="utf-8")
        mutated = source.with_suffix(".o")
        assert compile_object(source, mutated, ["-O1", *ADDRESS_SANITIZER])
        objects = [mutated if path == ROOT / mutant.file else found for path, found in self._common.items()]
        for tests in sorted(self.programs, key=lambda path: (_distance(path, source.stem), path)):
            program = folder / "program"
            linked = [self._own[tests], *objects]
            command: list[str | Path] = [COMPILER, *ADDRESS_SANITIZER, "-pthread", *linked, "-lm", "-o", program]
            if run(command, folder, os.environ, LIMIT) != 0:
                return True
            if any(run([program, name], folder, os.environ, LIMIT) != 0 for name in names_in(tests)):
                return True
        return False


def _distance(tests: Path, name: str) -> int:
    """0 for the tests that have the name of the file, 1 for others that include its header, 2 for the rest."""
    if name.startswith(tests.stem.removesuffix("_tests")):
        return 0
    return 1 if f"epg/{name}.h" in tests.read_text(encoding="utf-8") else 2


def compile_object(source: Path, output: Path, options: Sequence[str]) -> bool:
    command = [COMPILER, *OPTIONS, *options, "-c", str(source), "-o", str(output)]
    return subprocess.run(command, capture_output=True, check=False).returncode == 0


def differs(mutant: Mutant, folder: Path) -> bool:
    """True if a mutant compiles, and its object code differs from the original's."""
    source = folder / Path(mutant.file).name
    codes = []
    for text in ((ROOT / mutant.file).read_text(encoding="utf-8"), mutant.text()):
        source.write_text(text, encoding="utf-8")
        output = source.with_suffix(".o")
        if not compile_object(source, output, ["-O2"]):
            return False
        codes.append(output.read_bytes())
    return codes[0] != codes[1]
