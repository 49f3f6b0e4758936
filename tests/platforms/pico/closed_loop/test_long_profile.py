# SPDX-License-Identifier: Apache-2.0
"""JIWY's RP2040 images run the whole motion profile of examples/jiwy: 18 simulated seconds each."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.emulator.toolchain import ROOT
from tests.platforms.pico.images import PLATFORMS, skip_unless_emulated

from .checks import assert_all_is_well
from .comparison import compare

SCENARIO = ROOT / "examples" / "jiwy" / "tracking.yaml"


@pytest.mark.parametrize("platform", PLATFORMS)
def test_the_image_homes_and_follows_as_the_host_does(platform: str, tmp_path: Path) -> None:
    skip_unless_emulated(platform)
    assert_all_is_well(compare(platform, SCENARIO, {"pan": 1.2, "tilt": 0.7}, tmp_path))
