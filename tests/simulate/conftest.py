# SPDX-License-Identifier: Apache-2.0
"""Fixture: a host executable for the tests of simulation runs."""

from __future__ import annotations

from pathlib import Path

import pytest

from .motor import compile_motor


@pytest.fixture(scope="session")
def motor(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Topic ``motor_setpoint``; signals ``inputs.position``, ``outputs.duty``; disabled by 3 overruns in a row."""
    return compile_motor(tmp_path_factory.mktemp("motor") / "motor_host")
