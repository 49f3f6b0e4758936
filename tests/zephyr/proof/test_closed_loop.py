# SPDX-License-Identifier: Apache-2.0
"""Zephyr's image of JIWY on a Pico in closed loop, with the same bits as on the host."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.platforms.pico.closed_loop.checks import assert_all_is_well
from tests.platforms.pico.closed_loop.comparison import compare_image
from tests.platforms.pico.closed_loop.test_profile import SCENARIOS
from tests.platforms.pico.xrce.board import CONSOLE_PORT

from .board import ZephyrJiwy, image, skip_unless_emulated

WHERE = {"core": ZephyrJiwy.core, "console": CONSOLE_PORT}
LATEST = 8
"""Cycles within which a setpoint arrives over the console.  Reading two numbers takes 3 ms on the single core, on which
control has priority; on EPG's other platforms for a Pico, communication has its own core."""
LARGEST_COUNTS = 6.0
"""Tolerance of test_profile.py, 4 counts, plus the motion of an axis in 2 ms more."""


@pytest.mark.parametrize("scenario", SCENARIOS)
def test_it_homes_and_follows_as_the_host_does(scenario: str, tmp_path: Path) -> None:
    skip_unless_emulated()
    compared = compare_image(image(), *SCENARIOS[scenario], tmp_path, **WHERE)
    assert_all_is_well(compared, latest=LATEST, largest=LARGEST_COUNTS)
