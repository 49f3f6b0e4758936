# SPDX-License-Identifier: Apache-2.0
"""Builds for real boards with Zephyr's own test runner."""

from __future__ import annotations

from pathlib import Path

from tests.doubles.toolchain import arm_gcc, skip_if_missing

from .twister import statuses_of
from .workspace import c_library, need_twister, workspace


def test_boards(tmp_path: Path) -> None:
    """The builds for real boards succeed; a warning is an error."""
    boards = ("rpi_pico", "rpi_pico2/rp2350a/m33", "nucleo_h743zi")
    skip_if_missing(arm_gcc, c_library, lambda: need_twister(workspace(*boards)))
    statuses = statuses_of(tmp_path / "twister", *boards)
    tests = ("drivers.sensor.epg_qdec.build", "epg.jiwy.build", "sample.epg.qdec")
    expected = {(test, board.split("/")[0]) for test in tests for board in boards}
    assert {key for key, status in statuses.items() if status in ("passed", "not run")} == expected
    assert set(statuses) == expected
