# SPDX-License-Identifier: Apache-2.0
"""Fixtures: JIWY on the host with its console, as a user builds it, with sanitizers."""

from __future__ import annotations

import shutil
import subprocess
import sys
from pathlib import Path

import pytest

pytest.register_assert_rewrite("tests.middlewares.xrce.checks")  # so that a failure shows the values

HERE = Path(__file__).resolve().parent


def build_jiwy(build: Path, sanitizers: str) -> Path:
    """The executable, built in the folder ``build``."""
    for tool, package in (("cmake", "cmake"), ("ninja", "ninja-build")):
        if not shutil.which(tool):
            pytest.skip(f"{tool} is missing: apt install {package}")
    flags = f"-O1 -g -fsanitize={sanitizers} -fno-sanitize-recover=all"
    options = [f"-DPython3_EXECUTABLE={sys.executable}", f"-DCMAKE_C_FLAGS={flags}"]
    commands = [
        ["cmake", "-S", str(HERE / "jiwy"), "-B", str(build), "-G", "Ninja", *options],
        ["cmake", "--build", str(build), "--target", "jiwy_host"],
    ]
    for command in commands:
        done = subprocess.run(command, capture_output=True, text=True, check=False, timeout=600)
        assert done.returncode == 0, done.stdout + done.stderr
    return build / "jiwy_host"


@pytest.fixture(scope="session")
def jiwy_host(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return build_jiwy(tmp_path_factory.mktemp("jiwy"), "address,undefined")


@pytest.fixture(scope="session")
def jiwy_host_for_races(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return build_jiwy(tmp_path_factory.mktemp("jiwy_races"), "thread")
