# SPDX-License-Identifier: Apache-2.0
"""The faults of an agent on FreeRTOS that test_agent_faults.py omits."""

from __future__ import annotations

from tests.platforms.pico.images import skip_unless_emulated

from .board import Jiwy
from .scenarios import SCENARIOS, assert_is_back, hold


def test_all_of_them() -> None:
    skip_unless_emulated("freertos")
    with Jiwy("freertos") as jiwy:
        jiwy.home()
        for scenario in SCENARIOS.values():
            hold(jiwy)
            scenario(jiwy)
            assert_is_back(jiwy)
