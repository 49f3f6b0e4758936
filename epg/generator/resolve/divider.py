# SPDX-License-Identifier: Apache-2.0
"""Integer dividers: finds the prescaler and counter that make a frequency or a period from a clock.

The smallest possible prescaler leaves the largest counter, and so the finest steps of a duty cycle.  A search through
all prescalers could come nearer to a frequency, but with coarser steps.  It is made only for a period that must be
exact.  All numbers are integers or fractions: with floats, rounding would decide if a period is exact.

>>> divide(Fraction(125_000_000, 20_000), Divider((1, 255), (2, 65536)), exact=False)
Division(prescaler=1, counter=6250)
"""

from __future__ import annotations

import math
from fractions import Fraction

from epg.generator.catalog.hardware import Divider
from epg.generator.dataclass import dataclass

NEAR_ENOUGH = Fraction(1, 100)
"""The largest relative error of a divider that does not have to be exact."""


@dataclass(frozen=True)
class Division:
    """A setting of a divider: ``prescaler * counter`` clocks.  The counter runs from 0 to ``counter - 1``."""

    prescaler: int
    counter: int

    @property
    def clocks(self) -> int:
        return self.prescaler * self.counter


def divide(clocks: Fraction, divider: Divider, exact: bool) -> Division | None:
    """The setting for a number of ``clocks``, with the smallest possible prescaler, which gives the finest steps.

    With ``exact``, None if no setting gives exactly ``clocks``.  Otherwise the counter is rounded, and the result is
    None if the relative error is more than :data:`NEAR_ENOUGH`.
    """
    if exact:
        return _exactly(clocks.numerator, divider) if clocks.denominator == 1 else None
    prescaler = max(divider.prescaler[0], math.ceil(clocks / divider.counter[1]))
    if prescaler > divider.prescaler[1]:
        return None
    counter = min(max(round(clocks / prescaler), divider.counter[0]), divider.counter[1])
    found = Division(prescaler, counter)
    return found if abs(found.clocks - clocks) <= clocks * NEAR_ENOUGH else None


def clock_range(divider: Divider) -> tuple[int, int]:
    """The smallest and the largest number of clocks that a divider can count."""
    return divider.prescaler[0] * divider.counter[0], divider.prescaler[1] * divider.counter[1]


def neighbours(clocks: Fraction, divider: Divider, exact: bool) -> tuple[int, int]:
    """The nearest possible numbers of clocks below and above ``clocks``, which is in range but not possible itself."""
    first, last = clock_range(divider)
    below, above = math.floor(clocks), math.ceil(clocks)
    while below > first and divide(Fraction(below), divider, exact) is None:
        below -= 1
    while above < last and divide(Fraction(above), divider, exact) is None:
        above += 1
    return below, above


def _exactly(clocks: int, divider: Divider) -> Division | None:
    for prescaler in range(divider.prescaler[0], divider.prescaler[1] + 1):
        counter, rest = divmod(clocks, prescaler)
        if rest == 0 and divider.counter[0] <= counter <= divider.counter[1]:
            return Division(prescaler, counter)
    return None
