# SPDX-License-Identifier: Apache-2.0
"""The rest of the matrix: all ways, conventions, CMakes and generators.  Part of ``check_long``: it takes minutes."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.cmake.matrix.cells import ALL, PAIRWISE, Cell, check
from tests.cmake.matrix.ways import Installations

REST = [cell for cell in ALL if cell not in PAIRWISE]


@pytest.mark.parametrize("cell", REST, ids=str)
def test_cell(cell: Cell, installations: Installations, tmp_path: Path) -> None:
    check(cell, installations, tmp_path)
