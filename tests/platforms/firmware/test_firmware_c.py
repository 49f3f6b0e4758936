# SPDX-License-Identifier: Apache-2.0
"""The platform's C around a fake application: each ``TEST(name)`` of ``c/firmware_tests.c`` is a test here."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.runtime.program import (
    FAKES,
    ROOT,
    compile_program,
    component_sources,
    names_in,
    run_program,
    runtime_sources,
)

TESTS = Path(__file__).resolve().parent / "c" / "firmware_tests.c"
PLATFORM = ROOT / "targets" / "platforms" / "firmware"


@pytest.fixture(scope="module")
def program(tmp_path_factory: pytest.TempPathFactory) -> Path:
    sources = [TESTS, *FAKES, PLATFORM / "src" / "firmware.c", *runtime_sources(), *component_sources()]
    folder = tmp_path_factory.mktemp("firmware")
    return compile_program(folder / "tests", sources, includes=[PLATFORM / "include", PLATFORM / "src"])


@pytest.mark.parametrize("name", names_in(TESTS))
def test_in_c(program: Path, name: str) -> None:
    done = run_program([program, name])
    assert done.returncode == 0, done.stderr
