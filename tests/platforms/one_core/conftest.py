# SPDX-License-Identifier: Apache-2.0
"""A board with one core that runs JIWY."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

from .board import OneCore

PROGRAMS = [(board, platform) for board in ("mps2_an386", "mps2_an500") for platform in ("bare_metal", "freertos")]


@pytest.fixture(params=PROGRAMS, ids="-".join)
def program(request: pytest.FixtureRequest) -> tuple[str, str]:
    """Board and platform."""
    found: tuple[str, str] = request.param
    return found


@pytest.fixture
def board(program: tuple[str, str]) -> Iterator[OneCore]:
    with OneCore(*program) as running:
        yield running
