# SPDX-License-Identifier: Apache-2.0
"""Commands act whether or not a terminal has set DTR, also in the instant in which it falls; RP2040 in the emulator."""

from __future__ import annotations

import pytest

from tests.platforms.pico.dtr import CHECKS, Board, check_race
from tests.platforms.pico.images import PLATFORMS, images, skip_unless_emulated


@pytest.mark.parametrize("platform", PLATFORMS)
@pytest.mark.parametrize("check", CHECKS)
def test_commands_act(platform: str, check: str) -> None:
    skip_unless_emulated(platform)
    elf = images("pico", platform, "jiwy_firmware", middleware="console") / "jiwy_firmware.elf"
    CHECKS[check](lambda **usb: Board(elf, 0, usb))


@pytest.mark.parametrize("rounds", [200, 1000])
@pytest.mark.parametrize("platform", PLATFORMS)
def test_the_last_line_counts(platform: str, rounds: int) -> None:
    skip_unless_emulated(platform)
    elf = images("pico", platform, "jiwy_firmware", middleware="console") / "jiwy_firmware.elf"
    check_race(lambda **usb: Board(elf, 0, usb), rounds)
