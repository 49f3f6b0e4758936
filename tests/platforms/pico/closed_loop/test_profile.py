# SPDX-License-Identifier: Apache-2.0
"""JIWY's RP2040 images in closed loop, compared with the host: homing and one motion, or 18 s of motions."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.doubles.toolchain import ROOT
from tests.platforms.pico.images import PLATFORMS, skip_unless_emulated

from .checks import assert_all_is_well
from .comparison import compare

SCENARIOS = {
    "short": (Path(__file__).resolve().parent / "short.yaml", {"pan": 0.2, "tilt": 0.2}),
    "whole": (ROOT / "examples" / "jiwy" / "tracking.yaml", {"pan": 1.2, "tilt": 0.7}),
}
"""Each with the angles at the start, in rad."""


@pytest.mark.parametrize("scenario", SCENARIOS)
@pytest.mark.parametrize("platform", PLATFORMS)
def test_the_image_homes_and_follows_as_the_host_does(platform: str, scenario: str, tmp_path: Path) -> None:
    skip_unless_emulated(platform)
    assert_all_is_well(compare(platform, *SCENARIOS[scenario], tmp_path))
