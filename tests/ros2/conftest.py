"""Robots on a DDS network of their own, as a user builds them."""

from __future__ import annotations

import shutil
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from tests.emulator.toolchain import Missing, tool
from tests.ros2.network import Network, network

HERE = Path(__file__).resolve().parent

Build = Callable[[str], Path]
"""``build("follower")``: the host executable of a target of ``robots/CMakeLists.txt``."""


def builder(folder: Path, flags: str) -> Build:
    """Configures ``robots`` once; targets are built when they are asked for."""
    try:
        tool("cyclonedds")
    except Missing as problem:
        pytest.skip(str(problem))
    for program, package in (("cmake", "cmake"), ("ninja", "ninja-build")):
        if not shutil.which(program):
            pytest.skip(f"{program} is missing: apt install {package}")
    options = [f"-DPython3_EXECUTABLE={sys.executable}", f"-DCMAKE_C_FLAGS={flags}", f"-DCMAKE_CXX_FLAGS={flags}"]
    _run("cmake", "-S", str(HERE / "robots"), "-B", str(folder), "-G", "Ninja", *options)

    def build(target: str) -> Path:
        _run("cmake", "--build", str(folder), "--target", f"{target}_host")
        return folder / f"{target}_host"

    return build


def _run(*command: str) -> None:
    done = subprocess.run(command, capture_output=True, text=True, check=False, timeout=600)
    assert done.returncode == 0, done.stdout + done.stderr


@pytest.fixture(scope="session")
def build(tmp_path_factory: pytest.TempPathFactory) -> Build:
    return builder(tmp_path_factory.mktemp("robots"), "-O2")


@pytest.fixture(scope="session")
def build_checked(tmp_path_factory: pytest.TempPathFactory) -> Build:
    """With AddressSanitizer and UndefinedBehaviorSanitizer, and all warnings as errors."""
    flags = "-O1 -g -fsanitize=address,undefined -fno-sanitize-recover=all"
    warnings = "-Wall -Wextra -Wconversion -Wdouble-promotion -Werror"
    return builder(tmp_path_factory.mktemp("robots_checked"), f"{flags} {warnings}")


@pytest.fixture
def net() -> Iterator[Network]:
    with network() as found:
        yield found
