# SPDX-License-Identifier: Apache-2.0
"""The timing of JIWY with 20 USB hosts, 60 simulated seconds for each load."""

from __future__ import annotations

import pytest

from tests.platforms.pico.images import PLATFORMS, skip_unless_emulated

from .checks import assert_on_time
from .many import measure_many
from .measure import LOADS, Load
from .programs import Program


@pytest.mark.parametrize("load", LOADS, ids=lambda load: load.title)
@pytest.mark.parametrize("platform", PLATFORMS)
def test_every_cycle_is_on_time(platform: str, load: Load) -> None:
    skip_unless_emulated(platform)
    timing = measure_many(Program(platform, load.period), load, range(20), seconds=3.0)
    assert timing.cycles >= 60_000
    assert_on_time(timing)
