# SPDX-License-Identifier: Apache-2.0
"""Integer dividers: the prescaler and counter that make a frequency or a period of a clock.

>>> divide(Fraction(125_000_000, 20_000), Divider((1, 255), (2, 65536)), exact=False)
Division(prescaler=1, counter=6250)
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from fractions import Fraction

from epg.catalog.hardware import Divider
from epg.quantity import UNITS, units_of

NEAR_ENOUGH = Fraction(1, 100)
"""The largest relative error of a divider that need not be exact."""


@dataclass(frozen=True)
class Division:
    """``prescaler * counter`` clocks; the counter runs from 0 to ``counter - 1``."""

    prescaler: int
    counter: int

    @property
    def clocks(self) -> int:
        return self.prescaler * self.counter


def divide(clocks: Fraction, divider: Divider, exact: bool) -> Division | None:
    """The division nearest to ``clocks``, with the smallest prescaler as that gives the finest steps.

    None when there is no exact one, or none within :data:`NEAR_ENOUGH`.
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
    """The fewest and most clocks that a divider counts."""
    return divider.prescaler[0] * divider.counter[0], divider.prescaler[1] * divider.counter[1]


def neighbours(clocks: Fraction, divider: Divider, exact: bool) -> tuple[int, int]:
    """The possible numbers of clocks next to ``clocks``, which is in range but not possible: below and above."""
    first, last = clock_range(divider)
    below, above = math.floor(clocks), math.ceil(clocks)
    while below > first and divide(Fraction(below), divider, exact) is None:
        below -= 1
    while above < last and divide(Fraction(above), divider, exact) is None:
        above += 1
    return below, above


def show(value: Fraction | float, dimension: str, rounding: int = 0, digits: int = 6) -> str:
    """A time in s or a frequency in Hz as people write it: ``20 kHz``, ``133.693 ms``.

    ``digits`` is how many are shown; ``rounding`` -1 never shows more than ``value``, 1 never less.
    """
    value = Fraction(value)
    units = [unit for unit in units_of(dimension) if unit != "min"]
    unit = next((unit for unit in reversed(units) if Fraction(UNITS[unit][1]) <= value), units[0])
    number = value / Fraction(UNITS[unit][1])
    places = max(0, digits - len(str(math.floor(number))))
    scaled = number * 10**places
    whole = round(scaled) if rounding == 0 else math.floor(scaled) if rounding < 0 else math.ceil(scaled)
    text = str(whole // 10**places)
    rest = f"{whole % 10**places:0{places}d}".rstrip("0") if places else ""
    return f"{text}.{rest} {unit}" if rest else f"{text} {unit}"


def _exactly(clocks: int, divider: Divider) -> Division | None:
    for prescaler in range(divider.prescaler[0], divider.prescaler[1] + 1):
        counter, rest = divmod(clocks, prescaler)
        if rest == 0 and divider.counter[0] <= counter <= divider.counter[1]:
            return Division(prescaler, counter)
    return None
