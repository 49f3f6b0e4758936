# SPDX-License-Identifier: Apache-2.0
"""JIWY's RP2040 images in closed loop: homing and one motion, compared with the host."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.platforms.pico.images import PLATFORMS, skip_unless_emulated

from .checks import assert_all_is_well
from .comparison import compare

SCENARIO = Path(__file__).resolve().parent / "short.yaml"


@pytest.mark.parametrize("platform", PLATFORMS)
def test_the_image_homes_and_follows_as_the_host_does(platform: str, tmp_path: Path) -> None:
    skip_unless_emulated(platform)
    assert_all_is_well(compare(platform, SCENARIO, {"pan": 0.2, "tilt": 0.2}, tmp_path))
