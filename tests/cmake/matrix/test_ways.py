# SPDX-License-Identifier: Apache-2.0
"""Every way of finding EPG, toolchain convention, CMake and generator; each pair of them occurs together."""

from __future__ import annotations

from itertools import combinations, product
from pathlib import Path

import pytest

from tests.cmake.matrix.cells import ALL, PAIRWISE, Cell, check
from tests.cmake.matrix.ways import Installations


@pytest.mark.parametrize("cell", PAIRWISE, ids=str)
def test_way(cell: Cell, installations: Installations, tmp_path: Path) -> None:
    check(cell, installations, tmp_path)


def test_every_pair_of_values_meets() -> None:
    columns = ("way", "convention", "cmake", "generator")
    for one, other in combinations(columns, 2):
        met = {(getattr(cell, one), getattr(cell, other)) for cell in PAIRWISE}
        possible = product({getattr(cell, one) for cell in ALL}, {getattr(cell, other) for cell in ALL})
        assert met == set(possible), (one, other)
