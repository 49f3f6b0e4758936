"""Every way of finding EPG, under every toolchain convention, with the oldest CMake and the newest."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.cmake.matrix.cells import WAYS_AND_CONVENTIONS, Cell, check
from tests.cmake.matrix.ways import Installations


@pytest.mark.parametrize("cell", WAYS_AND_CONVENTIONS, ids=str)
def test_way(cell: Cell, installations: Installations, tmp_path: Path) -> None:
    check(cell, installations, tmp_path)
