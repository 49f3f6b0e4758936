# SPDX-License-Identifier: Apache-2.0
"""Hostile bytes for a board that is a ROS 2 node.  The programs are in xrce/ and run here without libFuzzer.

With clang, a longer search (docs/development.md):

    cmake -S tests/fuzz/xrce -B build/fuzz -G Ninja -DCMAKE_C_COMPILER=clang -DLIBFUZZER=ON && cmake --build build/fuzz
    build/fuzz/xrce_fuzz -max_len=400 corpus/
"""

from __future__ import annotations

import subprocess
from pathlib import Path

import pytest

from tests.cmake.built import built
from tests.doubles.toolchain import skip_if_missing, xrce_libraries

PROJECT = Path(__file__).resolve().parent / "xrce"
INPUTS = 20_000


@pytest.fixture(scope="module")
def programs(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of the programs, built with sanitizers."""
    skip_if_missing(xrce_libraries)
    return built(PROJECT, tmp_path_factory.mktemp("received_bytes"))


@pytest.mark.parametrize("name", ["xrce_fuzz", "message_fuzz"])
def test_samples_and_random_inputs(programs: Path, name: str) -> None:
    """The samples are inputs that reach different code, as found by libFuzzer, and inputs that once showed a bug."""
    corpus = PROJECT / f"{name}.txt"
    command = [str(programs / name), f"-corpus={corpus}", f"-random={INPUTS}"]
    done = subprocess.run(command, capture_output=True, text=True, check=False, timeout=600)
    assert done.returncode == 0, done.stdout + done.stderr
    assert done.stdout == f"{len(corpus.read_text().splitlines())} samples, {INPUTS} random inputs\n"
