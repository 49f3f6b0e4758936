# SPDX-License-Identifier: Apache-2.0
"""The console's protocol: each ``TEST(name)`` of ``c/*_tests.c``, with sanitizers."""

from __future__ import annotations

import importlib.util
import subprocess
import sys
from pathlib import Path
from types import ModuleType

import pytest

ROOT = Path(__file__).resolve().parents[2]
CONSOLE = ROOT / "targets" / "middlewares" / "console"
HERE = Path(__file__).resolve().parent / "c"
TESTS = {path.stem: path for path in sorted(HERE.glob("*_tests.c"))}


def _runtime_tests() -> ModuleType:
    """The module that compiles tests of the runtime: for the same flags, fake port and fake application."""
    path = ROOT / "tests" / "runtime" / "program.py"
    spec = importlib.util.spec_from_file_location("runtime_program", path)
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module
    spec.loader.exec_module(module)
    return module


program = _runtime_tests()


@pytest.fixture(scope="session")
def programs(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    """The test programs, by name."""
    folder = tmp_path_factory.mktemp("console")
    sources = [HERE / "console_bench.c", *program.FAKES, *sorted(CONSOLE.glob("*.c")), *program.runtime_sources()]
    includes = [CONSOLE, HERE]
    shared = program.compile_objects(folder / "shared", sources, includes=includes)
    return {
        name: program.compile_program(folder / name, [tests, *shared], includes=includes)
        for name, tests in TESTS.items()
    }


@pytest.mark.parametrize(
    ("tests", "name"), [(tests, name) for tests, source in TESTS.items() for name in program.names_in(source)]
)
def test_in_c(programs: dict[str, Path], tests: str, name: str) -> None:
    done = program.run_program([programs[tests], name])
    assert done.returncode == 0, done.stderr


def test_it_needs_no_heap_and_no_printf(tmp_path: Path) -> None:
    """Besides EPG's runtime, the console needs only functions that copy and compare bytes."""
    undefined: set[str] = set()
    defined: set[str] = set()
    for source in [*CONSOLE.glob("*.c"), *program.runtime_sources()]:
        output = tmp_path / f"{source.parent.name}_{source.stem}.o"
        command = ["gcc", "-std=c11", "-Os", "-fno-stack-protector", "-fno-builtin", f"-I{program.RUNTIME / 'include'}"]
        subprocess.run([*command, "-c", str(source), "-o", str(output)], check=True)
        for line in subprocess.run(["nm", str(output)], capture_output=True, text=True, check=True).stdout.splitlines():
            letter, name = line.split()[-2:]
            (undefined if letter == "U" else defined).add(name)
    port = {f"epg_port_{name}" for name in ("time_ns", "wait_until", "serial", "boot_id", "store_read", "store_write")}
    text = {
        "memcpy",
        "memmove",
        "memset",
        "memchr",
        "memcmp",
        "strchr",
        "strcmp",
        "strcspn",
        "strlen",
        "strncmp",
        "strrchr",
        "strspn",
    }
    assert undefined - defined <= {*port, *text, "strstr", "_GLOBAL_OFFSET_TABLE_"}
