# SPDX-License-Identifier: Apache-2.0
"""The agent's time by libmicroros, in the clock of a test: each ``TEST(name)`` in ``c/``.  Needs no libmicroros."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.middlewares.test_console_c import program

MICRO_ROS = Path(__file__).resolve().parents[1] / "targets" / "middlewares" / "micro_ros"
HERE = Path(__file__).resolve().parent / "c"


@pytest.fixture(scope="session")
def clock_tests(tmp_path_factory: pytest.TempPathFactory) -> Path:
    output: Path = program.compile_program(
        tmp_path_factory.mktemp("micro_ros_clock") / "clock_tests",
        [HERE / "clock_tests.c", MICRO_ROS / "micro_ros_clock.c", *program.FAKES, *program.runtime_sources()],
        includes=[MICRO_ROS, HERE],
    )
    return output


@pytest.mark.parametrize("name", program.names_in(HERE / "clock_tests.c"))
def test_clock(clock_tests: Path, name: str) -> None:
    done = program.run_program([clock_tests, name])
    assert done.returncode == 0, done.stderr
