# SPDX-License-Identifier: Apache-2.0
"""The sine of setpoints: within one unit in the last place of the C library's, and the same on every system."""

from __future__ import annotations

import hashlib
import itertools
import math
import random
import struct
from collections.abc import Iterator
from fractions import Fraction

import pytest

from epg.runs.scenario import ProfilePart
from epg.runs.sine import cosine, sine


def arguments() -> Iterator[float]:
    """Angles of all sizes, and those beside multiples of pi / 4, where a sine or a cosine is small."""
    generator = random.Random(7)
    yield from (0.0, -0.0, 5e-324, 2.0**-27, 1.7976931348623157e308)
    for _ in range(10000):
        yield generator.uniform(-math.pi, math.pi)
        yield generator.uniform(-1e4, 1e4)
    for exponent in range(-1074, 1024):
        yield math.copysign(math.ldexp(generator.uniform(0.5, 1.0), exponent), generator.uniform(-1.0, 1.0))
    for number in range(-2000, 2000):
        nearest = number * math.pi / 4
        yield from (math.nextafter(nearest, -math.inf), nearest, math.nextafter(nearest, math.inf))


def test_it_is_within_one_unit_in_the_last_place_of_the_c_library() -> None:
    for x in arguments():
        for own, of_library in ((sine(x), math.sin(x)), (cosine(x), math.cos(x))):
            assert abs(own - of_library) <= math.ulp(of_library), x
    assert math.copysign(1.0, sine(-0.0)) == -1.0


def test_it_is_the_same_on_every_system() -> None:
    """The digest of the bits, which was computed on one system and must be that of all others."""
    bits = b"".join(struct.pack("<dd", sine(x), cosine(x)) for x in itertools.islice(arguments(), 5000))
    assert hashlib.sha256(bits).hexdigest() == "0e4a46a603e8211237a97164678d63aa33efae1641aea2c137824e7276a30820"


@pytest.mark.parametrize("x", [1e-3, 0.5, 1.0, 3.0, 22.0, 100.5])
def test_it_is_the_nearest_double(x: float) -> None:
    """Compared with the Taylor series in exact fractions."""
    exact, term = Fraction(0), Fraction(x)
    for n in itertools.count(2, 2):
        exact += term
        term *= -(Fraction(x) ** 2) / (n * (n + 1))
        if n > abs(x) and abs(term) < Fraction(1, 2**200):
            break
    assert sine(x) == exact.numerator / exact.denominator


def test_the_double_that_is_nearest_to_a_multiple_of_a_right_angle() -> None:
    """J.-M. Muller, Elementary Functions, chapter 11.  A C library was wrong by 8 units here."""
    assert cosine(6381956970095103.0 * 2.0**797) == -4.68716592425462761112e-19


@pytest.mark.parametrize("shape", ["sine", "raised_cosine", "move"])
def test_setpoints_do_not_use_the_c_library(shape: str, monkeypatch: pytest.MonkeyPatch) -> None:
    part = ProfilePart(shape, start=1.0, duration=2.0, target=0.7, frequency=3.0)
    before = [part.value(1.0 + k / 700, 0.2) for k in range(1400)]
    for name in ("sin", "cos"):
        monkeypatch.setattr(math, name, lambda x: 0.125)
    assert [part.value(1.0 + k / 700, 0.2) for k in range(1400)] == before
