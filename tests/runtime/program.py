# SPDX-License-Identifier: Apache-2.0
"""Compiles C tests with the runtime, the component drivers and a port layer that the tests control."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
from collections.abc import Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from tests.compiler_cache import run_compiler

ROOT = Path(__file__).resolve().parents[2]
RUNTIME = ROOT / "targets" / "runtime"
COMPONENTS = ROOT / "targets" / "components"
SOURCES = Path(__file__).resolve().parent / "c"
PORT = ROOT / "tests" / "doubles" / "port"
FAKES = [PORT / "fake_port.c", PORT / "fake_application.c"]

WARNINGS = ["-Wall", "-Wextra", "-Wconversion", "-Wdouble-promotion", "-Wshadow", "-pedantic", "-Werror"]
ADDRESS_SANITIZER = ["-fsanitize=address,undefined", "-fno-sanitize-recover=all", "-fno-omit-frame-pointer"]
THREAD_SANITIZER = ["-fsanitize=thread"]


def compile_program(
    output: Path,
    sources: Sequence[Path],
    *,
    options: Sequence[str] = ("-O1", *ADDRESS_SANITIZER),
    defines: Sequence[str] = (),
    includes: Sequence[Path] = (),
) -> Path:
    """Compiles ``sources`` as C11 with the project's warnings as errors into the executable ``output``.

    ``sources`` may contain the objects of :func:`compile_objects`.
    """
    return build_program(_compiler(options, defines, includes), output, sources)


def build_program(compiler: Sequence[str], output: Path, sources: Sequence[Path]) -> Path:
    """Compiles and links the executable ``output``; ``compiler`` is the command with its options."""
    objects = _objects(compiler, output.with_name(f"{output.name}.objects"), sources)
    _run_compiler([*compiler, *map(str, objects), "-pthread", "-lm", "-o", str(output)])
    return output


def compile_objects(
    folder: Path,
    sources: Sequence[Path],
    *,
    options: Sequence[str] = ("-O1", *ADDRESS_SANITIZER),
    includes: Sequence[Path] = (),
) -> list[Path]:
    """Compiles each of ``sources`` into an object in ``folder``, for several programs."""
    return _objects(_compiler(options, (), includes), folder, sources)


def _objects(compiler: Sequence[str], folder: Path, sources: Sequence[Path]) -> list[Path]:
    """The objects of the C files among ``sources``, and the other ``sources``.  ccache keeps single objects only."""
    folder.mkdir(exist_ok=True)

    def compile_one(number: int, source: Path) -> Path:
        if source.suffix != ".c":
            return source
        output = folder / f"{number}_{source.stem}.o"
        _run_compiler([*compiler, "-pthread", "-c", str(source), "-o", str(output)])
        return output

    with ThreadPoolExecutor(os.cpu_count()) as pool:
        return list(pool.map(compile_one, range(len(sources)), sources))


def _compiler(options: Sequence[str], defines: Sequence[str], includes: Sequence[Path]) -> list[str]:
    compiler = shutil.which("gcc") or shutil.which("cc")
    assert compiler is not None, "a C compiler is needed"
    folders = [RUNTIME / "include", SOURCES, PORT, *sorted(p for p in COMPONENTS.iterdir() if p.is_dir()), *includes]
    command = [compiler, "-std=c11", "-g", "-ffp-contract=off", *WARNINGS, *options]
    return command + [f"-I{folder}" for folder in folders] + [f"-D{define}" for define in defines]


def _run_compiler(command: Sequence[str]) -> None:
    done = run_compiler(command, ROOT)
    assert done.returncode == 0, done.stderr


def runtime_sources() -> list[Path]:
    """All C files of the runtime."""
    return sorted((RUNTIME / "src").glob("*/*.c"))


def component_sources() -> list[Path]:
    """All C files of the component kinds."""
    return sorted(COMPONENTS.glob("*/*.c"))


def names_in(source: Path) -> list[str]:
    """The names of all ``TEST(name)`` in a C file, in order."""
    return re.findall(r"^TEST\((\w+)\)", source.read_text(), flags=re.MULTILINE)


def run_program(
    command: Sequence[str | Path], *, environment: Mapping[str, str] | None = None
) -> subprocess.CompletedProcess[str]:
    """Runs a program and captures its output; the caller checks its exit status.  ``environment`` extends this one."""
    return subprocess.run(
        [str(part) for part in command],
        capture_output=True,
        text=True,
        check=False,
        timeout=300,
        env={**os.environ, **(environment or {})},
    )
