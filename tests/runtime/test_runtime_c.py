# SPDX-License-Identifier: Apache-2.0
"""The C tests: each ``TEST(name)`` of ``c/*_tests.c`` is a test here, under Address- and UndefinedBehaviorSanitizer."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from .program import (
    FAKES,
    SOURCES,
    compile_objects,
    compile_program,
    component_sources,
    names_in,
    run_program,
    runtime_sources,
)

PROGRAMS = sorted(SOURCES.glob("*_tests.c"))


CASES = [
    pytest.param(source, name, id=f"{source.stem.removesuffix('_tests')}-{name}")
    for source in PROGRAMS
    for name in names_in(source)
]


@pytest.fixture(scope="session")
def program_of(tmp_path_factory: pytest.TempPathFactory) -> Callable[[Path], Path]:
    """The program for a C test file; each is compiled once, and so are the sources that all of them contain."""
    folder = tmp_path_factory.mktemp("c")
    programs: dict[Path, Path] = {}
    shared = compile_objects(folder / "shared", [*FAKES, *runtime_sources(), *component_sources()])

    def build(source: Path) -> Path:
        if source not in programs:
            programs[source] = compile_program(folder / source.stem, [source, *shared])
        return programs[source]

    return build


@pytest.mark.parametrize(("source", "name"), CASES)
def test_in_c(program_of: Callable[[Path], Path], source: Path, name: str) -> None:
    done = run_program([program_of(source), name])
    assert done.returncode == 0, done.stderr


def test_a_test_that_does_not_exist_fails(tmp_path: Path) -> None:
    source = tmp_path / "none.c"
    source.write_text('#include "check.h"\nTEST(entered)\n{\n    CHECK(1);\n}\nRUN()\n')
    program = compile_program(tmp_path / "none", [source])
    assert run_program([program, "entered"]).returncode == 0
    assert run_program([program, "forgotten"]).returncode == 2


def test_a_check_that_does_not_hold_fails(tmp_path: Path) -> None:
    source = tmp_path / "wrong.c"
    source.write_text('#include "check.h"\nTEST(wrong)\n{\n    CHECK_EQUAL(1, 2);\n}\nRUN()\n')
    program = compile_program(tmp_path / "wrong", [source])
    done = run_program([program, "wrong"])
    assert done.returncode == 1
    assert "1 is 1, not 2" in done.stderr
