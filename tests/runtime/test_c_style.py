# SPDX-License-Identifier: Apache-2.0
"""The C of runtime, drivers and their tests passes other tools: other compilers' modes, cppcheck, clang-format."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
from graphlib import TopologicalSorter
from pathlib import Path

import pytest

from tests.checkout import listed

from .program import (
    COMPONENTS,
    FAKES,
    ROOT,
    RUNTIME,
    SOURCES,
    WARNINGS,
    compile_program,
    component_sources,
    runtime_sources,
)

CONSOLE = ROOT / "targets" / "middlewares" / "console"
DRIVERS = sorted(COMPONENTS.glob("*/*.[ch]"))
HEADERS = sorted((RUNTIME / "include").rglob("*.h"))
FORMATTED = re.compile(
    r"(targets|examples/pico_quadrature)/.*\.[ch]$|tests/(.*/(c|programs?|rom|mps2)|doubles/.*)/[^/]*\.(c|h|cpp)$"
)


INCLUDES = [
    (path, name)
    for path in sorted((ROOT / "targets").rglob("*.[ch]"))
    for name in re.findall(r'^ *# *include "(.+)"', path.read_text(encoding="utf-8"), re.MULTILINE)
]
"""Each file of ``targets``, with each name that it includes in quotation marks."""


def compile_only(compiler: str, source: Path, output: Path, *options: str) -> None:
    command = [compiler, *options, *WARNINGS, f"-I{RUNTIME / 'include'}", "-c", str(source), "-o", str(output)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr


@pytest.mark.parametrize("header", [*HEADERS, *[d for d in DRIVERS if d.suffix == ".h"]], ids=lambda path: path.name)
def test_header_stands_alone_and_may_be_included_twice(header: Path, tmp_path: Path) -> None:
    source = tmp_path / "alone.c"
    source.write_text(f'#include "{header}"\n#include "{header}"\nextern int used;\nint used;\n')
    compile_only("gcc", source, tmp_path / "alone.o", "-std=c11")


@pytest.mark.parametrize("name", ["status.h", "fault.h", "statistics.h", "port.h", "finite.h"])
def test_header_of_users_is_cpp_too(name: str, tmp_path: Path) -> None:
    """The headers that a user's C++ main() or a C++ model includes; control.h and exchange.h need C11 atomics."""
    source = tmp_path / "alone.cpp"
    source.write_text(f'#include "epg/{name}"\nextern int used;\nint used;\n')
    options = ["-std=c++17", "-Wall", "-Wextra", "-Wconversion", "-pedantic", "-Werror"]
    command = ["g++", *options, f"-I{RUNTIME / 'include'}", "-c", str(source), "-o", str(tmp_path / "alone.o")]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr


@pytest.mark.parametrize("optimise", ["-O0", "-O2", "-O3", "-Os"])
@pytest.mark.parametrize("source", runtime_sources(), ids=lambda path: path.name)
def test_runtime_has_no_warnings_at_any_optimisation(source: Path, optimise: str, tmp_path: Path) -> None:
    compile_only("gcc", source, tmp_path / "object.o", "-std=c11", optimise)


@pytest.fixture(scope="module")
def symbols(tmp_path_factory: pytest.TempPathFactory) -> list[tuple[str, str]]:
    """The letter and the name of each symbol of the runtime, as nm prints them.

    Position-independent code would have constants with addresses in .data.rel.ro, which nm lists as data.
    """
    folder = tmp_path_factory.mktemp("objects")
    objects = [str(folder / f"{source.stem}.o") for source in runtime_sources()]
    for source, output in zip(runtime_sources(), objects, strict=True):
        compile_only("gcc", source, Path(output), "-std=c11", "-Os", "-fno-stack-protector", "-fno-pie")
    lines = subprocess.run(["nm", *objects], capture_output=True, text=True, check=True).stdout.splitlines()
    return [(words[-2], words[-1]) for line in lines if (words := line.split())[1:]]


def test_runtime_needs_no_heap_and_no_library_but_string_h(symbols: list[tuple[str, str]]) -> None:
    """The linker must only add the port layer, and functions that copy, clear and compare bytes."""
    undefined = {name for letter, name in symbols if letter == "U"}
    defined = {name for letter, name in symbols if letter != "U"}
    port = {f"epg_port_{name}" for name in ("time_ns", "wait_until", "serial", "boot_id", "store_read", "store_write")}
    text = {"memcmp", "memcpy", "memmove", "memset", "strchr", "strcmp", "strlen", "strncmp", "strrchr", "strstr"}
    assert undefined - defined <= {*text, *port, "_GLOBAL_OFFSET_TABLE_"}


def test_runtime_has_no_state_of_its_own(symbols: list[tuple[str, str]]) -> None:
    """The caller owns all state: .data and .bss are empty, so that several targets can be in one image."""
    assert [name for letter, name in symbols if letter in "bBdDcC"] == []


def test_drivers_work_with_fast_math(tmp_path: Path) -> None:
    """NaN is detected by its bits, even with a compiler that assumes that there is no NaN."""
    program = compile_program(
        tmp_path / "fast",
        [
            SOURCES / "driver_tests.c",
            FAKES[0],
            *(RUNTIME / "src" / "control" / name for name in ("bridge.c", "outputs.c")),
            *component_sources(),
        ],
        options=["-O2", "-ffast-math"],
    )
    for name in ("bridge_coasts_on_a_duty_that_is_not_finite", "pwm_is_safe_on_a_duty_that_is_not_finite"):
        assert subprocess.run([str(program), name], check=False).returncode == 0


@pytest.mark.skipif(shutil.which("cppcheck") is None, reason="cppcheck is not installed: sudo apt install cppcheck")
def test_cppcheck_finds_nothing() -> None:
    drivers = [d for d in DRIVERS if d.suffix == ".c" or not d.with_suffix(".c").exists()]  # a header with its source
    command = ["cppcheck", "--std=c11", "--language=c", "--enable=warning,style,performance,portability"]
    command += ["--inline-suppr", "--error-exitcode=1", "--quiet", "--suppress=missingIncludeSystem"]
    command += [f"-I{RUNTIME / 'include'}", *map(str, [*runtime_sources(), *drivers, *sorted(CONSOLE.glob("*.c"))])]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr


def test_parts_include_each_other_by_their_include_folders() -> None:
    """A name may lead to the folder above; a header of another part is found by a folder that CMake gives."""
    assert [f"{path}: {name}" for path, name in INCLUDES if name.startswith("../../")] == []


def test_no_circle_of_includes() -> None:
    """A header and the source of the same name beside it are one.  An exception of graphlib names a circle."""
    files = {path.as_posix(): path.with_suffix("") for path in (ROOT / "targets").rglob("*.[ch]")}
    graph: dict[Path, set[Path]] = {unit: set() for unit in files.values()}
    for path, name in INCLUDES:
        beside = os.path.normpath(path.parent / name)
        ends = (f"/include/{name}", f"/src/{name}")
        found = {files[beside]} if beside in files else {unit for file, unit in files.items() if file.endswith(ends)}
        graph[path.with_suffix("")] |= found - {path.with_suffix("")}
    assert sum(map(len, graph.values())) > len(graph)
    TopologicalSorter(graph).prepare()


def clang_format_version() -> int:
    """The installed major version; 0 if clang-format is missing."""
    if shutil.which("clang-format") is None:
        return 0
    shown = subprocess.run(["clang-format", "--version"], capture_output=True, text=True, check=True).stdout
    found = re.search(r"version (\d+)", shown)
    return int(found[1]) if found else 0


@pytest.mark.skipif(
    clang_format_version() != 14, reason="clang-format 14 is not installed: sudo apt install clang-format-14"
)
def test_files_are_formatted() -> None:
    """All C of targets, and that of their tests."""
    command = ["clang-format", f"--style=file:{ROOT / '.clang-format'}", "--dry-run", "--Werror"]
    done = subprocess.run([*command, *filter(FORMATTED.match, listed())], cwd=ROOT, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
