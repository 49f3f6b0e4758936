# SPDX-License-Identifier: Apache-2.0
"""Runs the model checker spin."""

from __future__ import annotations

import re
import shutil
import subprocess
from pathlib import Path

import pytest

needs_spin = pytest.mark.skipif(shutil.which("spin") is None, reason="spin is not installed: sudo apt install spin")


def spin(model: Path, folder: Path, *defines: str) -> str:
    """The output of the verifier of ``model`` after a search of its whole state space."""
    options = [f"-D{define}" for define in defines]
    subprocess.run(["spin", "-a", *options, str(model)], cwd=folder, check=True, capture_output=True)
    # -DSAFETY: assertions and end states only; the search is exact (no -DBITSTATE).  -DCOLLAPSE saves memory.
    options = ["-O2", "-w", "-DSAFETY", "-DCOLLAPSE"]
    subprocess.run(["gcc", *options, "-o", "pan", "pan.c"], cwd=folder, check=True, capture_output=True)
    return subprocess.run(["./pan", "-m100000", "-w22"], cwd=folder, check=False, capture_output=True, text=True).stdout


def check_search(report: str, least_states: int) -> None:
    """The search was complete, had more than ``least_states`` states, and found nothing wrong."""
    assert "errors: 0" in report, report
    assert "max search depth too small" not in report, report
    assert "Search not completed" not in report, report
    assert re.search(r"assertion violations\s+\+", report), report
    assert re.search(r"invalid end states\s+\+", report), report
    states = re.search(r"(\d+) states, stored", report)
    assert states is not None, report
    assert int(states[1]) > least_states, report
