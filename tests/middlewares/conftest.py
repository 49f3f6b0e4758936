# SPDX-License-Identifier: Apache-2.0
"""Fixtures: JIWY on the host with its console, as a user builds it, with sanitizers."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.cmake.built import built

pytest.register_assert_rewrite("tests.middlewares.xrce.checks")  # so that a failure shows the values

HERE = Path(__file__).resolve().parent


def build_jiwy(build: Path, sanitizers: str) -> Path:
    """The executable, built in the folder ``build``."""
    flags = f"-DCMAKE_C_FLAGS=-O1 -g -fsanitize={sanitizers} -fno-sanitize-recover=all"
    return built(HERE / "jiwy", build, flags, targets=["jiwy_host"]) / "jiwy_host"


@pytest.fixture(scope="session")
def jiwy_host(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return build_jiwy(tmp_path_factory.mktemp("jiwy"), "address,undefined")


@pytest.fixture(scope="session")
def jiwy_host_for_races(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return build_jiwy(tmp_path_factory.mktemp("jiwy_races"), "thread")
