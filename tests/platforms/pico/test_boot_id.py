# SPDX-License-Identifier: Apache-2.0
"""The number of a start comes from the ring oscillator of the chip: another one after each reset."""

from __future__ import annotations

import pytest

from tests.platforms.pico.closed_loop.board import Board, image
from tests.platforms.pico.images import PLATFORMS, skip_unless_emulated


@pytest.mark.parametrize("platform", PLATFORMS)
def test_each_start_has_another_number(platform: str) -> None:
    skip_unless_emulated(platform)
    numbers = []
    with Board(image(platform), {"pan": 0.12, "tilt": 0.12}) as board:
        for _ in range(4):
            numbers.append(board.pico.word("boot_id"))
            board.pico.call("reset")
            board.pico.receive()
            board.pico.run_until_text("ready", milliseconds=1000)
        assert board.pico.call("faults") == []
    assert 0 not in numbers
    assert len({*numbers}) == 4
