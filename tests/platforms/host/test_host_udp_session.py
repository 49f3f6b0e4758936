# SPDX-License-Identifier: Apache-2.0
"""The console's connection by UDP: each ``TEST(name)`` of ``programs/udp_session_tests.c``, with sanitizers."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.runtime.program import compile_program, names_in, run_program

from .program import CONSOLE, HOST, PROGRAMS, SCAN

TESTS = PROGRAMS / "udp_session_tests.c"


@pytest.fixture(scope="module")
def program(tmp_path_factory: pytest.TempPathFactory) -> Path:
    sources = [TESTS, HOST / "src" / "links" / "realtime" / "udp_session.c", *SCAN]
    return compile_program(tmp_path_factory.mktemp("udp") / "tests", sources, includes=[HOST / "src", CONSOLE])


@pytest.mark.parametrize("name", names_in(TESTS))
def test_in_c(program: Path, name: str) -> None:
    done = run_program([program, name])
    assert done.returncode == 0, done.stderr
