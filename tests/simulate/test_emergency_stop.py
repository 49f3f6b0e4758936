# SPDX-License-Identifier: Apache-2.0
"""A generated target whose plant, which has no init function, drives the fail-safe input in every cycle."""

from __future__ import annotations

import itertools
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from epg.simulate import simulate

CART = Path(__file__).resolve().parent / "cart"


def build(folder: Path) -> Path:
    """The executable cart_host."""
    generator = ["-G", "Ninja"] if shutil.which("ninja") else []
    for command in (
        ["cmake", "-S", str(CART), "-B", str(folder), *generator, f"-DPython3_EXECUTABLE={sys.executable}"],
        ["cmake", "--build", str(folder)],
    ):
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stdout + done.stderr
    return folder / "cart_host"


def enabled(trace: Path) -> list[tuple[float, int]]:
    """The changes between enabled and disabled: time of the first cycle, and 1 or 0."""
    header, *lines = trace.read_text().splitlines()
    column = header.split(",").index("enabled")
    rows = [line.split(",") for line in lines]
    changes = [(float(rows[0][0]), int(rows[0][column]))]
    for before, row in itertools.pairwise(rows):
        if row[column] != before[column]:
            changes.append((float(row[0]), int(row[column])))
    return changes


EXPECTED = [(0.0, 1), (1.0, 0), (1.7, 1), (2.5, 0)]
"""The target is enabled at 0 s already: the plant's first outputs exist at the first tick."""


def test_a_scenario_forces_what_the_plant_drives(tmp_path: Path) -> None:
    if not shutil.which("cmake"):
        pytest.skip("CMake is not installed: sudo apt install cmake")
    result = simulate(build(tmp_path / "build"), CART / "emergency_stop.yaml", tmp_path / "out")
    assert result.passed, result.ending
    assert enabled(tmp_path / "out" / "trace.csv") == EXPECTED
    assert (result.statistics.faults, result.statistics.fault_component) == (2, "emergency_stop")
