# SPDX-License-Identifier: Apache-2.0
"""Fixture: a client program, built once."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.doubles.toolchain import Missing
from tests.doubles.xrce_agent.bare import bare_client


@pytest.fixture(scope="session")
def client_program() -> Path:
    try:
        return bare_client()
    except Missing as missing:
        pytest.skip(str(missing))
