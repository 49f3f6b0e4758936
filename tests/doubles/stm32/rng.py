# SPDX-License-Identifier: Apache-2.0
"""The random number generator.  Its words are the same in each run, and go on over resets.

Source: RM0433, 34 (RNG).
"""

from __future__ import annotations

import random
from collections.abc import Callable

RNG = 0x48021800
CR, SR, DR = 0x00, 0x04, 0x08
ENABLED, WORD_READY = 1 << 2, 1


class Rng:
    """``clocked``: the bus's clock is on.  ``kernel``: the frequency of the clock that it measures its noise with."""

    def __init__(self, clocked: Callable[[], bool], kernel: Callable[[], int]) -> None:
        self._clocked, self._kernel = clocked, kernel
        self._source = random.Random(1)
        self.words: list[int] = []
        """What the program has read, over all resets."""
        self.reset()

    def reset(self) -> None:
        self._control = 0

    def read(self, offset: int) -> int:
        ready = self._clocked() and bool(self._control & ENABLED) and self._kernel() > 0
        if offset == SR:
            return WORD_READY if ready else 0
        if offset == DR and ready:
            self.words.append(self._source.getrandbits(32))
            return self.words[-1]
        return self._control if offset == CR and self._clocked() else 0

    def write(self, offset: int, value: int) -> None:
        if offset == CR and self._clocked():
            self._control = value
