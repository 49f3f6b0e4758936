# SPDX-License-Identifier: Apache-2.0
"""Every way of finding EPG, toolchain convention, CMake and generator.

``check_all`` has each of them in some cell, ``check_long`` each pair of them.
"""

from __future__ import annotations

from itertools import combinations, product
from pathlib import Path

import pytest

from tests.cmake.matrix.cells import ALL, EACH, PAIRWISE, Cell, check
from tests.cmake.matrix.ways import Installations

COLUMNS = ("way", "convention", "cmake", "generator")


@pytest.mark.parametrize("cell", EACH, ids=str)
def test_way(cell: Cell, installations: Installations, tmp_path: Path) -> None:
    check(cell, installations, tmp_path)


@pytest.mark.parametrize("cell", [cell for cell in PAIRWISE if cell not in EACH], ids=str)
def test_all_pairs(cell: Cell, installations: Installations, tmp_path: Path) -> None:
    check(cell, installations, tmp_path)


def test_every_value_occurs() -> None:
    for column in COLUMNS:
        assert {getattr(cell, column) for cell in EACH} == {getattr(cell, column) for cell in ALL}
    for convention in {cell.convention for cell in ALL}:  # the oldest CMake and the newest one, with each convention
        assert {cell.cmake for cell in EACH if cell.convention == convention} == {"oldest", "newest"}


def test_every_pair_of_values_meets() -> None:
    for one, other in combinations(COLUMNS, 2):
        met = {(getattr(cell, one), getattr(cell, other)) for cell in PAIRWISE}
        possible = product({getattr(cell, one) for cell in ALL}, {getattr(cell, other) for cell in ALL})
        assert met == set(possible), (one, other)
