# SPDX-License-Identifier: Apache-2.0
"""C test programs with one mutated file.  A mutant costs one object, one link and one test.

All code under test is one static library.  The linker does not take a member of it whose symbols the mutated object
defines.  If the test includes the mutated file, the test is compiled again instead.  There are no sanitizers: a mutant
must be noticed by a check of its test.
"""

from __future__ import annotations

import shutil
import subprocess
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from tests.checkout import ROOT
from tests.compiler_cache import run_compiler
from tests.runtime.program import COMPONENTS, FAKES, PORT, RUNTIME, component_sources, names_in, runtime_sources
from tests.runtime.program import SOURCES as RUNTIME_TESTS

from .table import SafetyMutant, apply

COMPILER = shutil.which("gcc") or shutil.which("cc") or "cc"
FOLDERS = [
    RUNTIME / "include",
    *sorted(path for path in (RUNTIME / "src").iterdir() if path.is_dir()),
    RUNTIME_TESTS,
    PORT,
    *sorted(path for path in COMPONENTS.iterdir() if path.is_dir()),
]
FLAGS = ["-std=c11", "-ffp-contract=off", "-pthread", "-w"]
CONSOLE_TESTS = ROOT / "tests" / "middlewares" / "c"
FIRMWARE_TESTS = ROOT / "tests" / "platforms" / "firmware" / "c"
CONSOLE = ROOT / "targets" / "middlewares" / "console"
FIRMWARE = ROOT / "targets" / "platforms" / "firmware"

LIBRARY = [
    *runtime_sources(),
    *component_sources(),
    *sorted(CONSOLE.glob("*.c")),
    FIRMWARE / "src" / "firmware.c",
    *FAKES,
    CONSOLE_TESTS / "console_bench.c",
]
SOURCES = [path for folder in (RUNTIME_TESTS, CONSOLE_TESTS, FIRMWARE_TESTS) for path in folder.glob("*_tests.c")]
PROGRAMS = {path.stem.removesuffix("_tests"): path for path in SOURCES}
INCLUDES = [*FOLDERS, CONSOLE, CONSOLE_TESTS, FIRMWARE / "include", FIRMWARE / "src"]
LIMIT = 20
"""Seconds after which a test counts as endless."""
FAILED_CHECK = 1
"""The exit status of a test whose check failed (check.h)."""


class Programs:
    """The test programs, in a folder of their own."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        (folder / "root").symlink_to(ROOT)
        self._tests: dict[str, Path] = {}
        outputs = [folder / f"{source.parent.name}_{source.stem}.o" for source in LIBRARY]
        with ThreadPoolExecutor() as pool:
            errors = "".join(pool.map(self._compile, LIBRARY, outputs))
        assert not errors, errors
        self._library = folder / "library.a"
        archiver = shutil.which("ar") or "ar"
        subprocess.run([archiver, "rcs", str(self._library), *map(str, outputs)], check=True)

    def status(self, name: str, test: str) -> int:
        """The exit status of a test without a mutant."""
        program = self._folder / name
        if not program.exists():
            self._link(program, [self._test_object(name)])
        return self._run(program, test)

    def status_with(self, mutant: SafetyMutant) -> int:
        """The exit status of the mutant's test.

        Raises :class:`ValueError` for a mutant that does not apply or compile, and :class:`subprocess.TimeoutExpired`
        for one with which the test does not end.
        """
        tree = self._folder / "tree"
        shutil.rmtree(tree, ignore_errors=True)
        _write(tree / mutant.file, apply(mutant, (ROOT / mutant.file).read_text(encoding="utf-8")))
        test = PROGRAMS[mutant.program]
        included = f'{Path(mutant.file).name}"' in test.read_text(encoding="utf-8")
        changed, objects = tree / mutant.file, [self._test_object(mutant.program)]
        if included or mutant.file.endswith(".h"):
            changed, objects = tree / test.relative_to(ROOT), []
            _write(changed, test.read_text(encoding="utf-8"))
        output = self._folder / "mutated.o"
        error = self._compile(changed, output, tree)
        if error:
            raise ValueError(f"{mutant.file}: the mutant does not compile: {error}")
        program = self._folder / "mutated"
        self._link(program, [*objects, output])
        return self._run(program, mutant.test)

    def _compile(self, source: Path, output: Path, tree: Path | None = None) -> str:
        """Compiles a source into an object, and returns the compiler's messages if it fails.

        ``tree`` has the mutated file, which is found before that of the project.  All names are relative to the folder,
        so that ccache knows the object again in another one.
        """
        root = self._folder / "root"
        mutated = [] if tree is None else [tree / folder.relative_to(ROOT) for folder in INCLUDES]
        folders = [*mutated, *(root / folder.relative_to(ROOT) for folder in INCLUDES)]
        source = root / source.relative_to(ROOT) if source.is_relative_to(ROOT) else source
        options = [*FLAGS, "-O0", *(f"-I{folder}" for folder in folders)]
        done = run_compiler([COMPILER, *options, "-c", str(source), "-o", str(output)], self._folder)
        return done.stderr if done.returncode else ""

    def _test_object(self, name: str) -> Path:
        if name not in self._tests:
            output = self._folder / f"{name}_tests.o"
            error = self._compile(PROGRAMS[name], output)
            assert not error, error
            self._tests[name] = output
        return self._tests[name]

    def _link(self, program: Path, objects: Sequence[Path]) -> None:
        command = [COMPILER, "-pthread", *map(str, objects), str(self._library), "-lm", "-o", str(program)]
        subprocess.run(command, check=True)

    def _run(self, program: Path, test: str) -> int:
        done = subprocess.run([program, test], capture_output=True, check=False, timeout=LIMIT)
        return done.returncode


def names_of(name: str) -> list[str]:
    return names_in(PROGRAMS[name])


def _write(path: Path, text: str) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text, encoding="utf-8")
