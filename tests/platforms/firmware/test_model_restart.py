# SPDX-License-Identifier: Apache-2.0
"""A model that is enabled again runs as it did first, in a program with its own linker script and start-up code.

The model never resets its variables.
"""

from __future__ import annotations

import struct

import pytest

from tests.doubles.mps2.qemu import Board, receive

from .images import MACHINES, image

RUNS, CYCLES = 3, 50


@pytest.mark.parametrize("processor", ["m3", "m7"])
def test_each_run_is_the_first(processor: str) -> None:
    with Board(MACHINES[processor], image(processor, "restart"), uarts=1) as board:
        (line,) = board.lines
        runs = [struct.unpack(f"<{CYCLES}d", receive(line, 8 * CYCLES)) for _ in range(RUNS)]
    assert runs[1:] == [runs[0]] * (RUNS - 1)
    assert 0 < runs[0][0] < runs[0][-1]
