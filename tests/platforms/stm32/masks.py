# SPDX-License-Identifier: Apache-2.0
"""How long code that masks interrupts delays the tick of an image on the emulated STM32H743.

Whenever the program is about to mask interrupts, the tick becomes pending, so that it waits for the whole stretch of
masked instructions.  It also becomes pending where only BASEPRI masks.  A tick that comes too early runs no control
cycle.

>>> # masks = Masks(chip, tick=54)
>>> # chip.run(0.1)
>>> # masks.longest                                   # {"vPortEnterCritical": 4}
"""

from __future__ import annotations

import re
from typing import Any

from tests.doubles.stm32.machine import Machine
from tests.doubles.stm32.nvic import FIRST
from tests.doubles.toolchain import binutils

FUNCTION = re.compile(r"^[0-9a-f]+ <(.+)>:$")
UNMASK = re.compile(r"^\s*([0-9a-f]+):\t.*\tcpsie\ti")
MASK = re.compile(r"^\s*([0-9a-f]+):\t.*\t(?:cpsid\t(.*)|msr\t(PRIMASK|BASEPRI|BASEPRI_MAX|FAULTMASK), (\w+))")
BASEPRI = ("BASEPRI", "BASEPRI_MAX")


class Masks:
    """``longest``: by function, the instructions that have delayed a tick, from the one after the mask to the one that
    ends it; ``times``: how often the tick was pending there.  Each is kept separately for BASEPRI."""

    def __init__(self, chip: Machine, tick: int) -> None:
        self.chip = chip
        self.longest: dict[str, int] = {}
        self.longest_by_basepri: dict[str, int] = {}
        self.times = 0
        self.times_by_basepri = 0
        self.functions: set[str] = set()
        """All functions of the image that set PRIMASK or FAULTMASK."""
        self._tick = FIRST + tick
        self._begun: tuple[str, bool, int] | None = None
        cpu, hook = chip.processor.cpu, chip.processor.module.UC_HOOK_CODE
        function = ""
        for line in binutils("objdump", "-d", str(chip.image.elf)).splitlines():
            if name := FUNCTION.match(line):
                function = name[1]
            elif found := MASK.match(line):
                address, basepri = int(found[1], 16), found[3] in BASEPRI
                if not basepri:
                    self.functions.add(function)
                cpu.hook_add(hook, self._at_mask, (function, basepri, found[4]), address, address)
            elif found := UNMASK.match(line):
                after = int(found[1], 16) + 2
                cpu.hook_add(hook, self._at_mask, (function, True, "BASEPRI"), after, after)
        enter = chip.processor.nvic.enter
        chip.processor.nvic.enter = lambda number: (self._entered(number), enter(number))[1]  # type: ignore[method-assign]

    def _executed(self) -> int:
        processor = self.chip.processor
        return processor.instructions + (processor.counters.executed if processor.in_run else 0)

    def _at_mask(self, _: Any, __: int, ___: int, place: tuple[str, bool, str | None]) -> None:
        function, basepri, register = place
        nvic = self.chip.processor.nvic
        bit = 1 << self._tick
        value = 1 if register is None else self.chip.processor.read(register.upper())
        if value and nvic.enabled & bit and not (nvic.active | nvic.pending) & bit:
            self._begun = (function, basepri, self._executed())
            nvic.pend(self._tick)

    def _entered(self, number: int) -> None:
        if number != self._tick or self._begun is None:
            return
        (function, basepri, begun), self._begun = self._begun, None
        longest = self.longest_by_basepri if basepri else self.longest
        longest[function] = max(longest.get(function, 0), self._executed() - begun)
        if basepri:
            self.times_by_basepri += 1
        else:
            self.times += 1
