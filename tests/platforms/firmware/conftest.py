# SPDX-License-Identifier: Apache-2.0
"""A board at the ticks of its timer."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

from .free_running import FreeRunning
from .images import MACHINES, image


@pytest.fixture(params=[("m3", "freertos"), ("m7", "bare")], ids="-".join)
def board(request: pytest.FixtureRequest) -> Iterator[FreeRunning]:
    processor, system = request.param
    with FreeRunning(MACHINES[processor], image(processor, f"free_running_{system}")) as running:
        yield running
