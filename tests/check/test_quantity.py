# SPDX-License-Identifier: Apache-2.0
"""Quantities are exact where possible, and errors in them get a clear message."""

from __future__ import annotations

import math
from fractions import Fraction

import pytest

from epg.generator.quantity import QuantityError, conversion_factor, dimension_of, parse_quantity, parse_ratio


@pytest.mark.parametrize(
    ("text", "dimension", "value"),
    [
        ("1 ms", "time", Fraction(1, 1000)),
        ("33ms", "time", Fraction(33, 1000)),
        ("0.1 us", "time", Fraction(1, 10_000_000)),
        ("1e3 Hz", "frequency", Fraction(1000)),
        ("20 kHz", "frequency", Fraction(20_000)),
        ("180 deg", "angle", math.pi),
        (" -2.5 rad ", "angle", Fraction(-5, 2)),
        ("50 %", "ratio", Fraction(1, 2)),
        (0.5, "ratio", Fraction(1, 2)),
        ("100 µs", "time", Fraction(1, 10_000)),
    ],
)
def test_quantities(text: object, dimension: str, value: Fraction | float) -> None:
    assert parse_quantity(text, dimension) == value


@pytest.mark.parametrize(
    ("text", "dimension", "message", "hint"),
    [
        (1, "time", "this time has no unit", "'1 s'"),
        (0.001, "time", "this time has no unit", "'0.001 s'"),
        (1e3, "frequency", "this frequency has no unit", "'1000 Hz'"),
        (math.nan, "frequency", "nan is not a frequency", "write a number and a unit (Hz"),
        ("1,5 ms", "time", "'1,5 ms' is written with a decimal comma", "'1.5 ms'"),
        ("fast", "angle", "'fast' is not an angle", "number"),
        ("1", "time", "this time has no unit", "ms"),
        ("1 Ms", "time", "unknown unit 'Ms'", "did you mean 'ms'?"),
        ("1 kHz", "time", "'kHz' is a unit of frequency, not of time", "ms"),
        ("one ms", "time", "'one ms' is not a time", "number"),
        ("12:30:00", "time", "unknown unit ':30:00'", "ms"),
        (True, "time", "this is not a time", "number"),
        ("1e999999999 s", "time", "'1e999999999 s' is not a time", "number"),
        ("nan s", "time", "'nan s' is not a time", "number"),
    ],
)
def test_no_quantities(text: object, dimension: str, message: str, hint: str) -> None:
    with pytest.raises(QuantityError) as caught:
        parse_quantity(text, dimension)
    assert str(caught.value) == message
    assert hint in caught.value.hint


@pytest.mark.parametrize(
    ("value", "ratio"), [("5625/361", Fraction(5625, 361)), (19, Fraction(19)), (0.1, Fraction(1, 10))]
)
def test_ratios_are_exact(value: object, ratio: Fraction) -> None:
    assert parse_ratio(value) == ratio


@pytest.mark.parametrize("value", ["1/0", "a/b", True, float("nan"), "1/2/3", None])
def test_no_ratios(value: object) -> None:
    with pytest.raises(QuantityError):
        parse_ratio(value)


def test_conversions_between_units() -> None:
    assert conversion_factor("rev", "rad") == 2 * math.pi
    assert conversion_factor("rad", "deg") == pytest.approx(180 / math.pi, rel=1e-15)
    assert conversion_factor("mm", "m") == 0.001
    with pytest.raises(ValueError, match="angle"):
        conversion_factor("rad", "s")
    assert dimension_of("Nm") == "torque"
    assert dimension_of("furlong") is None
