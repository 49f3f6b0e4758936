# SPDX-License-Identifier: Apache-2.0
"""Fixtures: host executables with the middleware xrce, as a user builds them."""

from __future__ import annotations

import shutil
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.emulator.toolchain import Missing
from tests.xrce_agent import Agent, UdpLink
from tests.xrce_agent.bare import libraries

HERE = Path(__file__).resolve().parent
SANITIZERS = "-O1 -g -fsanitize=address,undefined -fno-sanitize-recover=all"


def build(project: str, folder: Path, flags: str, *settings: str) -> Path:
    """Builds a project; returns the folder with the executables."""
    try:
        libraries()
    except Missing as missing:
        pytest.skip(str(missing))
    for tool, package in (("cmake", "cmake"), ("ninja", "ninja-build")):
        if not shutil.which(tool):
            pytest.skip(f"{tool} is missing: apt install {package}")
    options = [f"-DPython3_EXECUTABLE={sys.executable}", f"-DCMAKE_C_FLAGS={flags}", *settings]
    for command in (
        ["cmake", "-S", str(HERE / project), "-B", str(folder), "-G", "Ninja", *options],
        ["cmake", "--build", str(folder)],
    ):
        done = subprocess.run(command, capture_output=True, text=True, check=False, timeout=600)
        assert done.returncode == 0, done.stdout + done.stderr
    return folder


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
