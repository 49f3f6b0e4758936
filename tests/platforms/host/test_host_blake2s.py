# SPDX-License-Identifier: Apache-2.0
"""The keyed hash of the console by UDP: published numbers, in ``programs/blake2s_tests.c``, and Python's."""

from __future__ import annotations

import hashlib
from pathlib import Path

import pytest

from tests.runtime.program import compile_program, names_in, run_program

from .program import HOST, PROGRAMS

TESTS = PROGRAMS / "blake2s_tests.c"
HASH = HOST / "src" / "links" / "blake2s.c"


@pytest.fixture(scope="module")
def program(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return compile_program(tmp_path_factory.mktemp("blake2s") / "tests", [TESTS, HASH], includes=[HOST / "src"])


@pytest.mark.parametrize("name", names_in(TESTS))
def test_published_numbers(program: Path, name: str) -> None:
    done = run_program([program, name])
    assert done.returncode == 0, done.stderr


def test_it_is_the_hash_of_python(tmp_path: Path) -> None:
    sources = [PROGRAMS / "blake2s_table.c", HASH]
    found = run_program([compile_program(tmp_path / "table", sources, includes=[HOST / "src"])]).stdout.split()
    data = bytes(index * 7 % 256 for index in range(300))
    assert found == [
        hashlib.blake2s(data[:size], key=data[: size % 33], digest_size=1 + size % 32).hexdigest()
        for size in range(300)
    ]
