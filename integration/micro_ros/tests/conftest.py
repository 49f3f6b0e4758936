# SPDX-License-Identifier: Apache-2.0
"""Host executables with the middleware ``micro_ros``, as a user builds them, with the user's libmicroros."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.cmake.built import SANITIZERS
from tests.doubles.toolchain import cmake_and_ninja, skip_if_missing
from tests.doubles.xrce_agent import Agent, UdpLink

HERE = Path(__file__).resolve().parent
WARNINGS = "-Wall -Wextra -Wconversion -Wdouble-promotion -Werror"


def configure(folder: Path, *settings: str) -> subprocess.CompletedProcess[str]:
    if not os.environ.get("MICRO_ROS_PATH"):
        pytest.skip("MICRO_ROS_PATH does not name a libmicroros for this computer: its README says how to build one")
    skip_if_missing(cmake_and_ninja)
    flags = f"-DCMAKE_C_FLAGS={SANITIZERS} {WARNINGS}"
    python = f"-DPython3_EXECUTABLE={sys.executable}"
    command = ["cmake", "-S", str(HERE / "robot"), "-B", str(folder), "-G", "Ninja", flags, python, *settings]
    return subprocess.run(command, capture_output=True, text=True, check=False, timeout=600)


def build(folder: Path, *targets: str) -> subprocess.CompletedProcess[str]:
    command = ["cmake", "--build", str(folder), *(("--target", *targets) if targets else ())]
    return subprocess.run(command, capture_output=True, text=True, check=False, timeout=600)


@pytest.fixture(scope="session")
def builds(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder with the executables."""
    folder = tmp_path_factory.mktemp("micro_ros")
    for done in (configure(folder), build(folder)):
        assert done.returncode == 0, done.stdout + done.stderr
    return folder


@pytest.fixture(scope="session")
def robot(builds: Path) -> Path:
    return builds / "robot_host"


@pytest.fixture(scope="session")
def serial_robot(builds: Path) -> Path:
    return builds / "serial_robot_host"


@pytest.fixture
def agent() -> Iterator[Agent]:
    with Agent(UdpLink()) as made:
        yield made
