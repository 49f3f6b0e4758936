# SPDX-License-Identifier: Apache-2.0
"""Commands act whether or not a terminal has set DTR, also in the instant in which it falls: Zephyr's USB on a Pico."""

from __future__ import annotations

import pytest

from tests.platforms.pico.dtr import CHECKS, Board
from tests.platforms.pico.xrce.board import CONSOLE_PORT

from .board import image, skip_unless_emulated


@pytest.mark.parametrize("check", CHECKS)
def test_commands_act(check: str) -> None:
    skip_unless_emulated()
    elf = image()
    CHECKS[check](lambda **usb: Board(elf, CONSOLE_PORT, usb))
