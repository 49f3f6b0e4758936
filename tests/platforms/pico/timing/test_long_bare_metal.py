# SPDX-License-Identifier: Apache-2.0
"""The timing of JIWY on bare metal with 20 USB hosts, 60 simulated seconds for each load."""

from __future__ import annotations

import pytest

from tests.platforms.pico.images import skip_unless_emulated

from .checks import assert_on_time
from .many import measure_many
from .measure import LOADS, Load
from .programs import generated


@pytest.mark.parametrize("load", LOADS, ids=lambda load: load.title)
def test_every_cycle_is_on_time(load: Load) -> None:
    skip_unless_emulated("bare_metal")
    timing = measure_many(generated("bare_metal", load.period), load, range(20), seconds=3.0)
    assert timing.cycles >= 60_000
    assert_on_time(timing)
