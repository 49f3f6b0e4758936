# SPDX-License-Identifier: Apache-2.0
"""Zephyr's image of JIWY on a Pico in closed loop: homing and one motion, with the same bits as on the host."""

from __future__ import annotations

from pathlib import Path

from tests.emulator.toolchain import ROOT
from tests.platforms.pico.closed_loop.checks import assert_all_is_well
from tests.platforms.pico.closed_loop.comparison import compare_image
from tests.platforms.pico.xrce.board import CONSOLE_PORT

from .board import ZephyrJiwy, image, skip_unless_emulated

SHORT = ROOT / "tests" / "platforms" / "pico" / "closed_loop" / "short.yaml"
WHOLE = ROOT / "examples" / "jiwy" / "tracking.yaml"

WHERE = {"core": ZephyrJiwy.core, "console": CONSOLE_PORT}
LATEST = 8
"""Cycles within which a setpoint arrives over the console.  Reading two numbers takes 3 ms on the single core, on which
control has priority; on EPG's other platforms for a Pico, communication has its own core."""
LARGEST_COUNTS = 6.0
"""Tolerance of test_short_profile.py, 4 counts, plus the motion of an axis in 2 ms more."""


def test_it_homes_and_follows_as_the_host_does(tmp_path: Path) -> None:
    skip_unless_emulated()
    compared = compare_image(image(), SHORT, {"pan": 0.2, "tilt": 0.2}, tmp_path, **WHERE)
    assert_all_is_well(compared, latest=LATEST, largest=LARGEST_COUNTS)


def test_the_whole_motion_profile(tmp_path: Path) -> None:
    """This takes 18 simulated seconds."""
    skip_unless_emulated()
    compared = compare_image(image(), WHOLE, {"pan": 1.2, "tilt": 0.7}, tmp_path, **WHERE)
    assert_all_is_well(compared, latest=LATEST, largest=LARGEST_COUNTS)
