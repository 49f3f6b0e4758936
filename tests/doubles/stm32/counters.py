# SPDX-License-Identifier: Apache-2.0
"""unicorn's own counters of instructions, which its functions do not show.

``uc_emu_start`` with a count keeps two words side by side: the instructions executed so far, and the number after
which it stops.  Reading the first one gives the time within a run.  Writing the second one stops the run before the
next instruction, which ``uc_emu_stop`` does not do within an access to a register: the program counter would stay.
"""

from __future__ import annotations

import ctypes
from typing import Any

LARGEST = 4096
"""Bytes of unicorn's structure that are searched."""


class Counters:
    """``cpu``: a unicorn engine; ``code``: an address at which an endless loop may be executed."""

    def __init__(self, cpu: Any, code: int) -> None:
        words = (ctypes.c_size_t * (LARGEST // ctypes.sizeof(ctypes.c_size_t))).from_address(cpu._uch.value)
        places = set(range(len(words) - 1))
        for count in (0x12345, 0x777, 0x4321):
            cpu.emu_start(code | 1, 0xFFFFFFFE, count=count)
            places = {n for n in places if words[n + 1] == count and words[n] == count + 1}
        assert len(places) == 1, "this version of unicorn keeps its counters elsewhere"
        self._words = words
        self._place = places.pop()

    @property
    def executed(self) -> int:
        """Instructions of the present or last run."""
        return min(self._words[self._place], self._words[self._place + 1])

    @property
    def complete(self) -> bool:
        """True if the last run has executed as many instructions as it should."""
        return self._words[self._place] > self._words[self._place + 1]

    def stop_after(self, count: int) -> None:
        """Stops the run when it has executed ``count`` instructions; the present one is executed in any case."""
        self._words[self._place + 1] = max(count, self._words[self._place])
