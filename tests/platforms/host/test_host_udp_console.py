# SPDX-License-Identifier: Apache-2.0
"""The console by UDP with several clients: each ``TEST(name)`` of ``programs/udp_console_tests.c``, with sanitizers.

The sockets are real, and time is simulated, so each test knows the order in which datagrams arrive and cycles run.
"""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.runtime.program import FAKES, compile_program, names_in, run_program, runtime_sources

from .program import CONSOLE, HOST, PROGRAMS

TESTS = PROGRAMS / "udp_console_tests.c"
BENCH = Path(__file__).resolve().parents[2] / "middlewares" / "c"
MANY = 1_000_000


@pytest.fixture(scope="module")
def program(tmp_path_factory: pytest.TempPathFactory) -> Path:
    sources = [TESTS, PROGRAMS / "udp_client.c", BENCH / "console_bench.c"]
    sources += [*FAKES, *runtime_sources(), *CONSOLE.glob("*.c")]
    links = HOST / "src" / "links"
    sources += [
        links / "blake2s.c",
        links / "udp_address.c",
        *(links / "realtime").glob("udp_*.c"),
        links / "posix/udp_key.c",
    ]
    includes = [HOST / "src", links / "realtime", links / "posix", PROGRAMS, CONSOLE, BENCH]
    return compile_program(tmp_path_factory.mktemp("udp_console") / "tests", sources, includes=includes)


@pytest.mark.parametrize("name", names_in(TESTS))
def test_in_c(program: Path, name: str) -> None:
    done = run_program([program, name])
    assert done.returncode == 0, done.stderr


@pytest.mark.parametrize("name", [name for name in names_in(TESTS) if name.startswith("mutated_")])
def test_a_million_mutations(program: Path, name: str) -> None:
    done = run_program([program, name], environment={"EPG_MUTATIONS": str(MANY)})
    assert done.returncode == 0, done.stderr
