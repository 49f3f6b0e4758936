# SPDX-License-Identifier: Apache-2.0
"""Sine and cosine with the same bits on every system.

The C library of each system rounds ``math.sin()`` in its own way, so the last bit differs.  This module computes with
whole numbers only, by addition, multiplication and division.  The result is the double that is nearest to the exact
value; a wrong rounding would need an exact value within 2^-60 of the middle between two doubles.

Numbers in fixed point are whole numbers that count units of 2^-128.

>>> sine(0.5), cosine(0.5)
(0.479425538604203, 0.8775825618903728)
"""

from __future__ import annotations

from functools import cache

_BITS = 128
"""A multiple of pi / 2 is never nearer than 2^-62 to a double, so a sine has 66 bits or more in fixed point."""


def sine(x: float) -> float:
    """The sine of ``x`` (rad), which must be finite."""
    return x if abs(x) < 2.0**-27 else _of_quadrant(x, 0)  # x - x^3 / 6 is rounded to x


def cosine(x: float) -> float:
    """The cosine of ``x`` (rad), which must be finite."""
    return _of_quadrant(x, 1)


def _of_quadrant(x: float, quadrants: int) -> float:
    """The sine of ``x`` plus some quadrants."""
    numerator, denominator = x.as_integer_ratio()
    bits = _BITS + 64 * (max(numerator.bit_length() - denominator.bit_length(), 0) // 64 + 1)
    quadrant = _pi(bits) // 2
    scaled = (numerator << bits) // denominator
    turns = (2 * scaled + quadrant) // (2 * quadrant)  # the nearest multiple
    rest = (scaled - turns * quadrant) >> (bits - _BITS)  # from -pi/4 to pi/4
    square = rest * rest >> _BITS
    turns += quadrants
    value = _series(1 << _BITS, square, 1) if turns % 2 else _series(rest, square, 2)
    return (-value if turns % 4 > 1 else value) / (1 << _BITS)


def _series(term: int, square: int, n: int) -> int:
    """The sum of a Taylor series.  Each term is the last one times ``-square / (n (n + 1))``; n grows by 2."""
    total = 0
    while term:
        total += term
        term = -(term * square >> _BITS) // (n * (n + 1))
        n += 2
    return total


@cache
def _pi(bits: int) -> int:
    """Pi in units of 2^-bits, by Machin's formula: 16 atan(1/5) - 4 atan(1/239)."""
    guard = 32  # bits for the rounding errors of the terms
    return (16 * _arctangent(5, bits + guard) - 4 * _arctangent(239, bits + guard)) >> guard


def _arctangent(n: int, bits: int) -> int:
    """atan(1/n) in units of 2^-bits."""
    power = (1 << bits) // n
    total = power
    k = 1
    while power:
        power //= n * n
        k += 2
        total += -power // k if k % 4 == 3 else power // k
    return total
