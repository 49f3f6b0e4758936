# SPDX-License-Identifier: Apache-2.0
"""200 restarts of the agent: the board finds each new agent, no memory is lost, no control cycle is disturbed."""

from __future__ import annotations

import pytest

from tests.platforms.pico.images import PLATFORMS, skip_unless_emulated

from .board import Jiwy
from .scenarios import assert_is_back, hold, restart

RESTARTS = 200


@pytest.mark.parametrize("platform", PLATFORMS)
def test_restarts(platform: str) -> None:
    skip_unless_emulated(platform)
    with Jiwy(platform) as jiwy:
        jiwy.home()
        hold(jiwy)
        times = sorted(restart(jiwy, RESTARTS))
        middle = times[RESTARTS // 2]
        print(f"{platform}: first message {times[0]:.1f} ... {middle:.1f} ... {times[-1]:.1f} ms after the start")
        assert times[-1] < 3 * middle + 20, "none takes longer than others"
        assert_is_back(jiwy)
