# SPDX-License-Identifier: Apache-2.0
"""Fixtures: host executables with the middleware xrce, as a user builds them."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.cmake.built import SANITIZERS, built
from tests.doubles.toolchain import skip_if_missing, xrce_libraries
from tests.doubles.xrce_agent import Agent, UdpLink

from .board import Board

HERE = Path(__file__).resolve().parent


def build(project: str, folder: Path, flags: str, *settings: str) -> Path:
    """Builds a project; returns the folder with the executables."""
    skip_if_missing(xrce_libraries)
    return built(HERE / project, folder, f"-DCMAKE_C_FLAGS={flags}", *settings)


@pytest.fixture(scope="session")
def robot_build(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return build("robot", tmp_path_factory.mktemp("xrce_robot"), SANITIZERS)


@pytest.fixture(scope="session")
def robot(robot_build: Path) -> Path:
    return robot_build / "robot_host"


@pytest.fixture(scope="session")
def spoken_robot(robot_build: Path) -> Path:
    return robot_build / "spoken_host"


@pytest.fixture(scope="session")
def complete_robot(robot_build: Path) -> Path:
    """Publishes ``cycles`` in every control cycle, and ``cycles_too`` in every second one; leaves none out."""
    return robot_build / "complete_host"


@pytest.fixture(scope="session")
def disabling_robot(robot_build: Path) -> Path:
    return robot_build / "disabling_host"


@pytest.fixture(scope="session")
def jiwy_build(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return build("jiwy", tmp_path_factory.mktemp("xrce_jiwy"), SANITIZERS)


@pytest.fixture(scope="session")
def jiwy(jiwy_build: Path) -> Path:
    return jiwy_build / "jiwy_host"


@pytest.fixture(scope="session")
def small_jiwy(jiwy_build: Path) -> Path:
    return jiwy_build / "small_host"


@pytest.fixture
def agent() -> Iterator[Agent]:
    with Agent(UdpLink()) as made:
        yield made


@pytest.fixture
def board(robot: Path, agent: Agent) -> Iterator[Board]:
    """It publishes.  At the end, no sanitizer has reported an error."""
    with Board(robot, agent) as made:
        made.running()
        yield made
        assert made.stop() == ""
