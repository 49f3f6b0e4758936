# SPDX-License-Identifier: Apache-2.0
"""Quantities with units: ``1 ms``, ``20 kHz``, ``180 deg``, and units of model ports.

>>> parse_quantity("33 ms", "time")
Fraction(33, 1000)
>>> conversion_factor("deg", "rad")
0.017453292519943295
"""

from __future__ import annotations

import math
import re
from collections.abc import Collection
from fractions import Fraction

from epg.generator.correction import correction

#: unit -> (dimension, factor to the dimension's base unit).  Factors are exact fractions if the unit allows it.
UNITS: dict[str, tuple[str, Fraction | float]] = {
    "s": ("time", Fraction(1)),
    "ms": ("time", Fraction(1, 1000)),
    "us": ("time", Fraction(1, 1000_000)),
    "ns": ("time", Fraction(1, 1000_000_000)),
    "min": ("time", Fraction(60)),
    "Hz": ("frequency", Fraction(1)),
    "kHz": ("frequency", Fraction(1000)),
    "MHz": ("frequency", Fraction(1000_000)),
    "rad": ("angle", Fraction(1)),
    "mrad": ("angle", Fraction(1, 1000)),
    "deg": ("angle", math.pi / 180),
    "rev": ("angle", 2 * math.pi),
    "rad/s": ("angular velocity", Fraction(1)),
    "mrad/s": ("angular velocity", Fraction(1, 1000)),
    "deg/s": ("angular velocity", math.pi / 180),
    "rev/s": ("angular velocity", 2 * math.pi),
    "rpm": ("angular velocity", 2 * math.pi / 60),
    "m": ("length", Fraction(1)),
    "cm": ("length", Fraction(1, 100)),
    "mm": ("length", Fraction(1, 1000)),
    "m/s": ("velocity", Fraction(1)),
    "mm/s": ("velocity", Fraction(1, 1000)),
    "V": ("voltage", Fraction(1)),
    "mV": ("voltage", Fraction(1, 1000)),
    "A": ("current", Fraction(1)),
    "mA": ("current", Fraction(1, 1000)),
    "N": ("force", Fraction(1)),
    "N.m": ("torque", Fraction(1)),
    "%": ("ratio", Fraction(1, 100)),
    "": ("ratio", Fraction(1)),
}

#: Dimensions of values that keep something moving until they change: velocities, efforts, currents and duties.
IN_MOTION = frozenset({"velocity", "angular velocity", "force", "torque", "voltage", "current", "ratio"})

#: Other spellings of units, by 20-sim and by users.
SPELLINGS = {
    "Nm": "N.m",
    "N m": "N.m",
    "µs": "us",
    "μs": "us",
    "sec": "s",
    "degree": "deg",
    "degrees": "deg",
    "radian": "rad",
    "none": "",
    "-": "",
    "1": "",
}

UNIT_NAMES = {
    **dict.fromkeys(("second", "secs"), "s"),
    **dict.fromkeys(("millisecond", "msec"), "ms"),
    **dict.fromkeys(("microsecond", "usec"), "us"),
    **dict.fromkeys(("minute", "mins"), "min"),
    "hertz": "Hz",
    "kilohertz": "kHz",
    "megahertz": "MHz",
    **dict.fromkeys(("deg.", "°"), "deg"),
    **dict.fromkeys(("revolution", "turn", "rotation"), "rev"),
    **dict.fromkeys(("radian/s", "rad/sec"), "rad/s"),
    **dict.fromkeys(("degree/s", "deg/sec", "°/s"), "deg/s"),
    "rev/sec": "rev/s",
    **dict.fromkeys(("rev/min", "1/min", "r/min"), "rpm"),
    **dict.fromkeys(("meter", "metre"), "m"),
    **dict.fromkeys(("centimeter", "centimetre"), "cm"),
    **dict.fromkeys(("millimeter", "millimetre"), "mm"),
    **dict.fromkeys(("m/sec", "meter/s", "mps"), "m/s"),
    **dict.fromkeys(("mm/sec", "millimeter/s"), "mm/s"),
    **dict.fromkeys(("volt", "vdc"), "V"),
    "millivolt": "mV",
    **dict.fromkeys(("ampere", "amp"), "A"),
    **dict.fromkeys(("milliampere", "milliamp"), "mA"),
    "newton": "N",
    **dict.fromkeys(("newtonmeter", "newton meter", "newtonmetre", "n*m"), "N.m"),
    **dict.fromkeys(("percent", "pct"), "%"),
}
"""Names of units that EPG does not read, in lower case and in the singular, and the units that they mean."""

_NUMBER = r"[-+]?(?:[0-9]+(?:\.[0-9]*)?|\.[0-9]+)(?:[eE][-+]?[0-9]+)?"
_QUANTITY = re.compile(rf"({_NUMBER})\s*(\S.*?)?\s*")
_DECIMAL_COMMA = re.compile(r"[-+]?[0-9]+,[0-9]+(\s*[A-Za-zµμ%][\w./%]*)?")
_THOUSANDS = re.compile(r"[-+]?[1-9][0-9]{0,2},[0-9]{3}(\D.*)?")
_PREFIXES = ("k", "K", "M", "G", "m", "u", "n")
_LONGEST = 200
_RATIO = rf"({_NUMBER})\s*/\s*({_NUMBER})"


class QuantityError(ValueError):
    """The text is not a quantity of the expected dimension.

    ``hint`` says what the user must write instead.  ``id`` is the id of the diagnostic.
    """

    def __init__(self, message: str, hint: str = "", id: str = "wrong-quantity") -> None:
        super().__init__(message)
        self.hint = hint
        self.id = id


def decimal_comma(text: str) -> str:
    """The hint for a number with a decimal comma, with or without a unit; "" for other text.

    Three digits behind the comma can also be thousands: then the hint names both numbers.
    """
    if len(text) > _LONGEST or not _DECIMAL_COMMA.fullmatch(text.strip()):
        return ""
    if _THOUSANDS.fullmatch(text.strip()):
        point, without = text.strip().replace(",", "."), text.strip().replace(",", "")
        return f"write '{without}', or '{point}' with a decimal point"
    return correction(text.strip(), text.strip().replace(",", "."), "write '{}', with a decimal point", bare=True)


def number_hint(text: str) -> str:
    """A hint for a number in a wrong form: ``1,5``, ``80%`` or ``"3"``; "" if the meaning of ``text`` is not clear."""
    if decimal_comma(text):
        return decimal_comma(text)
    percent = re.fullmatch(r"\s*([-+]?[0-9]{1,9}(?:\.[0-9]{0,9})?)\s*%\s*", text)
    if percent:
        share = f"{float(Fraction(percent[1]) / 100):g}"
        return correction(text.strip(), share, f"write {{}} instead of {text.strip()}", bare=True)
    with_word = re.fullmatch(rf"\s*({_NUMBER})\s*([A-Za-z_]\w*)\s*", text)
    try:
        float(text.replace("_", ""))
    except ValueError:
        if with_word is None:
            return ""
        unit = with_word[2]
        # Without its unit, a quantity is another number: 1 ms is not 1, nor is 2k 2.
        if normal_unit(unit) in UNITS or meant_unit(unit, UNITS) or unit in _PREFIXES:
            return f"this number must not have a unit: write the number that {with_word[1]} {unit} means here"
        return correction(text.strip(), with_word[1], "write {}: this number must not have a unit", bare=True)
    plain = text.replace("_", "")
    if not math.isfinite(float(plain)):
        return "write a finite number"
    return correction(text, plain, "write {} without quotes or underscores", bare=True)


def units_of(dimension: str) -> list[str]:
    """All units of a dimension, smallest first: ``["ns", "us", "ms", "s", "min"]``."""
    return sorted((u for u, (d, _) in UNITS.items() if d == dimension and u), key=lambda u: float(UNITS[u][1]))


def show(value: Fraction | float, dimension: str, rounding: int = 0, digits: int = 6) -> str:
    """A time in s or a frequency in Hz with the unit that suits its size: ``20 kHz``, ``133.693 ms``.

    ``digits`` is the number of significant digits.  With ``rounding`` -1 the text is never more than ``value``, with 1
    never less, with 0 the nearest.
    """
    value = Fraction(value)
    units = [unit for unit in units_of(dimension) if unit != "min"]
    unit = next((unit for unit in reversed(units) if Fraction(UNITS[unit][1]) <= value), units[0])
    number = value / Fraction(UNITS[unit][1])
    if number >= 10**9:  # Such a number is a mistake.  An exponent keeps the message readable.
        return f"{float(number):.{digits}g} {unit}"
    places = max(0, digits - len(str(math.floor(number))))
    scaled = number * 10**places
    whole = round(scaled) if rounding == 0 else math.floor(scaled) if rounding < 0 else math.ceil(scaled)
    text = str(whole // 10**places)
    rest = f"{whole % 10**places:0{places}d}".rstrip("0") if places else ""
    return f"{text}.{rest} {unit}" if rest else f"{text} {unit}"


def base_unit(dimension: str) -> str:
    """The unit in which EPG computes values of a dimension: "s", "Hz", "rad"."""
    return next(unit for unit in units_of(dimension) if UNITS[unit][1] == 1)


def normal_unit(unit: str) -> str:
    """EPG's spelling of ``unit``.  An unknown unit is returned unchanged."""
    unit = unit.strip()
    return SPELLINGS.get(unit, unit)


def dimension_of(unit: str) -> str | None:
    """The dimension of a unit, or None for a unit that EPG does not know."""
    entry = UNITS.get(normal_unit(unit))
    return entry[0] if entry else None


def conversion_factor(source: str, target: str) -> float:
    """The factor that converts a number in the unit ``source`` to the unit ``target``.

    Raises ValueError if the two units have different dimensions, and KeyError for a unit that EPG does not know.
    """
    source_dimension, source_factor = UNITS[normal_unit(source)]
    target_dimension, target_factor = UNITS[normal_unit(target)]
    if source_dimension != target_dimension:
        raise ValueError(f"{source} is a unit of {source_dimension}, {target} of {target_dimension}")
    if isinstance(source_factor, Fraction) and isinstance(target_factor, Fraction):
        return float(source_factor / target_factor)
    return float(source_factor) / float(target_factor)


def parse_ratio(value: object) -> Fraction:
    """The exact value of a ratio that is written as a number or as ``5625/361``.  Raises :class:`QuantityError`."""
    problem = QuantityError("this is not a ratio", "write a number or a ratio such as 5625/361")
    if isinstance(value, bool):
        raise problem
    if isinstance(value, int):
        return Fraction(value)
    if isinstance(value, float) and math.isfinite(value):
        return Fraction(repr(value))
    if isinstance(value, str):
        match = re.fullmatch(_RATIO, value.strip()) if len(value) <= _LONGEST else None
        if match and _is_small(match[1]) and _is_small(match[2]) and Fraction(match[2]) != 0:
            return Fraction(match[1]) / Fraction(match[2])
        problem.hint = number_hint(value) or problem.hint
    raise problem


def parse_quantity(value: object, dimension: str) -> Fraction | float:
    """A quantity in the base unit of its dimension (s, Hz, rad, m, V, A, ...).

    The value is an exact fraction, or a float if the factor of the unit is not exact (``deg``).  Raises
    :class:`QuantityError` for text that is not a quantity, a unit of another dimension, or a number without a unit.
    """
    wanted = f"{'an' if dimension[0] in 'aeiou' else 'a'} {dimension}"
    if isinstance(value, (int, float)) and not isinstance(value, bool):
        if dimension == "ratio":
            return parse_ratio(value)
        raise _without_unit(value, dimension, wanted)
    if not isinstance(value, str):
        raise QuantityError(f"this is not {wanted}", _form_hint(dimension))
    number, unit = _number_and_unit(value, dimension, wanted)
    if not unit and dimension != "ratio":
        raise QuantityError(f"this {dimension} has no unit", _form_hint(dimension), "wrong-unit")
    if unit not in UNITS:
        raise QuantityError(f"unknown unit '{unit}'", _unit_hint(unit, units_of(dimension)), "wrong-unit")
    found, factor = UNITS[unit]
    if found != dimension:
        hint = _inverse_hint(number, unit, dimension) or _form_hint(dimension)
        raise QuantityError(f"'{unit}' is a unit of {found}, not of {dimension}", hint, "wrong-unit")
    return Fraction(number) * factor if isinstance(factor, Fraction) else float(Fraction(number)) * factor


def _number_and_unit(text: str, dimension: str, wanted: str) -> tuple[str, str]:
    """The number and the unit of a text, both as texts; ``wanted`` is the name of the dimension with its article."""
    if decimal_comma(text):
        raise QuantityError(f"'{text.strip()}' is written with a decimal comma", decimal_comma(text))
    match = _QUANTITY.fullmatch(text.strip()) if len(text) <= _LONGEST else None
    if not match or not _is_small(match[1]):
        shown = text if len(text) <= 60 else text[:57] + "..."
        raise QuantityError(f"'{shown}' is not {wanted}", _form_hint(dimension))
    return match[1], normal_unit(match[2] or "")


def _form_hint(dimension: str) -> str:
    return f"write a number and a unit ({', '.join(units_of(dimension))})"


def _without_unit(number: int | float, dimension: str, wanted: str) -> QuantityError:
    """The problem of a number in place of a quantity; ``wanted`` is the name of the dimension with its article."""
    if not math.isfinite(number):
        return QuantityError(f"{number} is not {wanted}", _form_hint(dimension))
    written = int(number) if number == int(number) and abs(number) < 1e15 else number
    units = ", ".join(units_of(dimension))
    example = f"write for example '{written} {base_unit(dimension)}'; units: {units}"
    return QuantityError(f"this {dimension} has no unit", example, "wrong-unit")


def _inverse_hint(number: str, unit: str, dimension: str) -> str:
    """The hint for a frequency in place of a time, or a time in place of a frequency; "" for other dimensions."""
    found, factor = UNITS[unit]
    if {found, dimension} != {"time", "frequency"} or Fraction(number) <= 0:
        return ""
    other = show(1 / (Fraction(number) * Fraction(factor)), dimension)
    return f"write '{other}': the {'period' if dimension == 'time' else 'frequency'} of {number} {unit}"


def _is_small(number: str) -> bool:
    """True if the number and its exponent are short.  ``1e999999999`` would make an exact fraction of enormous size."""
    exponent = re.search(r"[eE][-+]?(\d+)$", number)
    return len(number) <= 64 and (exponent is None or (len(exponent[1]) <= 3 and int(exponent[1]) <= 300))


def meant_unit(unit: str, units: Collection[str]) -> str:
    """The one of ``units`` that a text means: ``meters`` means m, ``khz`` kHz.  "" if none is meant."""
    word = " ".join(unit.split()).casefold()
    words = (word, word.removesuffix("s"), word.replace("s/", "/"))
    names = [UNIT_NAMES.get(name) or SPELLINGS.get(name, "") for name in words]
    same = [known for known in units if known.casefold() == word]
    return next((known for known in (*same, *names) if known and known in units), "")


def _unit_hint(unit: str, units: list[str]) -> str:
    meant = meant_unit(unit, units)
    return correction(unit, meant) if meant else f"units: {', '.join(units)}"
