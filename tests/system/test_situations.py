# SPDX-License-Identifier: Apache-2.0
"""The thesis's five network situations as systems: their limits hold, and their lags are those in the benchmarks."""

from __future__ import annotations

from pathlib import Path

import pytest

pytest.importorskip("numpy", reason="numpy is not installed: pip install numpy")

from epg.cli.build_simulation import build_simulation
from epg.generator.diagnostics import Diagnostics
from tests.system.situations import ROOT, ROWS, SITUATIONS, simulated_lags

PAGE = ROOT / "docs" / "benchmarks.md"


def documented(number: int) -> dict[str, list[int]]:
    """The last two columns of the rows of a situation in the tables of lags."""
    text = PAGE.read_text(encoding="utf-8").partition("<!-- begin network_situations -->")[2]
    rows = [[cell.strip() for cell in line.strip("|").split("|")] for line in text.splitlines() if line.startswith("|")]
    return {row[0]: [int(cell) for cell in row[-2:]] for row in rows if row[0] in ROWS[number]}


@pytest.mark.parametrize("number", ROWS)
def test_the_lags_on_the_page_are_those_of_the_simulation(number: int, tmp_path: Path) -> None:
    program = build_simulation(SITUATIONS / f"situation_{number}.system.yaml", tmp_path, Diagnostics())
    assert simulated_lags(number, program, tmp_path) == documented(number)
