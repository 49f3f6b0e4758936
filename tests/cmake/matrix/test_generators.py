"""Two ways of finding EPG with every other generator."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.cmake.matrix.cells import GENERATORS_AND_CMAKES, Cell, check
from tests.cmake.matrix.ways import Installations


@pytest.mark.parametrize("cell", GENERATORS_AND_CMAKES, ids=str)
def test_generator(cell: Cell, installations: Installations, tmp_path: Path) -> None:
    check(cell, installations, tmp_path)
