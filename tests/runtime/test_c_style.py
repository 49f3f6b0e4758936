# SPDX-License-Identifier: Apache-2.0
"""The C of runtime, drivers and their tests passes other tools: other compilers' modes, cppcheck, clang-format."""

from __future__ import annotations

import re
import shutil
import subprocess
from pathlib import Path

import pytest

from .program import COMPONENTS, ROOT, RUNTIME, SOURCES, WARNINGS, compile_program, component_sources, runtime_sources

DRIVERS = sorted(COMPONENTS.glob("*/*.[ch]"))
HEADERS = sorted((RUNTIME / "include").rglob("*.h"))
FILES = [*HEADERS, *sorted((RUNTIME / "src").glob("*/*")), *DRIVERS, *sorted(SOURCES.iterdir())]


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


def test_runtime_needs_no_heap_and_no_library_but_string_h(tmp_path: Path) -> None:
    """The linker must only add the port layer, and functions that copy, clear and compare bytes."""
    undefined: set[str] = set()
    defined: set[str] = set()
    for source in runtime_sources():
        output = tmp_path / f"{source.stem}.o"
        compile_only("gcc", source, output, "-std=c11", "-Os", "-fno-stack-protector")
        for line in subprocess.run(["nm", str(output)], capture_output=True, text=True, check=True).stdout.splitlines():
            letter, name = line.split()[-2:]
            (undefined if letter == "U" else defined).add(name)
    port = {f"epg_port_{name}" for name in ("time_ns", "wait_until", "serial", "store_read", "store_write")}
    text = {"memcmp", "memcpy", "memmove", "memset", "strchr", "strcmp", "strlen", "strncmp", "strrchr", "strstr"}
    assert undefined - defined <= {*text, *port, "_GLOBAL_OFFSET_TABLE_"}


def test_runtime_has_no_state_of_its_own(tmp_path: Path) -> None:
    """The caller owns all state: .data and .bss are empty, so that several targets can be in one image.

    Position-independent code would have constants with addresses in .data.rel.ro, which nm lists as data.
    """
    for source in runtime_sources():
        output = tmp_path / f"{source.stem}.o"
        compile_only("gcc", source, output, "-std=c11", "-Os", "-fno-pie")
        symbols = subprocess.run(["nm", str(output)], capture_output=True, text=True, check=True).stdout
        assert not [line for line in symbols.splitlines() if line.split()[-2] in "bBdDcC"], symbols


def test_drivers_work_with_fast_math(tmp_path: Path) -> None:
    """NaN is detected by its bits, even with a compiler that assumes that there is no NaN."""
    program = compile_program(
        tmp_path / "fast",
        [
            SOURCES / "driver_tests.c",
            SOURCES / "fake_port.c",
            *(RUNTIME / "src" / "control" / name for name in ("bridge.c", "outputs.c")),
            *component_sources(),
        ],
        options=["-O2", "-ffast-math"],
    )
    for name in ("bridge_coasts_on_a_duty_that_is_not_finite", "pwm_is_safe_on_a_duty_that_is_not_finite"):
        assert subprocess.run([str(program), name], check=False).returncode == 0


@pytest.mark.skipif(shutil.which("cppcheck") is None, reason="cppcheck is not installed: apt install cppcheck")
def test_cppcheck_finds_nothing() -> None:
    drivers = [d for d in DRIVERS if d.suffix == ".c" or not d.with_suffix(".c").exists()]  # a header with its source
    command = ["cppcheck", "--std=c11", "--language=c", "--enable=warning,style,performance,portability"]
    command += ["--inline-suppr", "--error-exitcode=1", "--quiet", "--suppress=missingIncludeSystem"]
    command += [f"-I{RUNTIME / 'include'}", *map(str, runtime_sources()), *map(str, drivers)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr


def clang_format_version() -> int:
    """The installed major version; 0 if clang-format is missing."""
    if shutil.which("clang-format") is None:
        return 0
    shown = subprocess.run(["clang-format", "--version"], capture_output=True, text=True, check=True).stdout
    found = re.search(r"version (\d+)", shown)
    return int(found[1]) if found else 0


@pytest.mark.skipif(
    clang_format_version() != 14, reason="clang-format 14 is not installed: apt install clang-format-14"
)
def test_files_are_formatted() -> None:
    command = ["clang-format", f"--style=file:{ROOT / '.clang-format'}", "--dry-run", "--Werror", *map(str, FILES)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
