"""The rest of the matrix: all ways, conventions, CMakes and generators.  Takes minutes: ``pytest -m long``."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.cmake.matrix.cells import ALL, GENERATORS_AND_CMAKES, WAYS_AND_CONVENTIONS, Cell, check
from tests.cmake.matrix.ways import Installations

pytestmark = pytest.mark.long

REST = [cell for cell in ALL if cell not in WAYS_AND_CONVENTIONS and cell not in GENERATORS_AND_CMAKES]


@pytest.mark.parametrize("cell", REST, ids=str)
def test_cell(cell: Cell, installations: Installations, tmp_path: Path) -> None:
    check(cell, installations, tmp_path)
