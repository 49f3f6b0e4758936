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
from fractions import Fraction

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
    "N.m": ("torque", Fraction(1)),
    "%": ("ratio", Fraction(1, 100)),
    "": ("ratio", Fraction(1)),
}

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

_NUMBER = r"[-+]?(?:[0-9]+(?:\.[0-9]*)?|\.[0-9]+)(?:[eE][-+]?[0-9]+)?"
_QUANTITY = re.compile(rf"({_NUMBER})\s*(\S.*?)?\s*")
_DECIMAL_COMMA = re.compile(r"[-+]?[0-9]+,[0-9]+(\s*[A-Za-zµμ%][\w./%]*)?")
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
    """The hint for a number with a decimal comma, with or without a unit; "" for other text."""
    if len(text) > _LONGEST or not _DECIMAL_COMMA.fullmatch(text.strip()):
        return ""
    return f"write '{text.strip().replace(',', '.')}', with a decimal point"


def number_hint(text: str) -> str:
    """A hint for a number in a wrong form: ``1,5``, ``80%`` or ``"3"``; "" if the meaning of ``text`` is not clear."""
    if decimal_comma(text):
        return decimal_comma(text)
    percent = re.fullmatch(r"\s*([-+]?[0-9]{1,9}(?:\.[0-9]{0,9})?)\s*%\s*", text)
    if percent:
        return f"write {float(Fraction(percent[1]) / 100):g} instead of {text.strip()}"
    with_word = re.fullmatch(rf"\s*({_NUMBER})\s*[A-Za-z_]\w*\s*", text)
    try:
        float(text.replace("_", ""))
    except ValueError:
        return f"write {with_word[1]}: this number must not have a unit" if with_word else ""
    return f"write {text.replace('_', '')} without quotes or underscores"


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


# One function, because each check relies on those before it, and their order decides the message.
def parse_quantity(value: object, dimension: str) -> Fraction | float:
    """A quantity in the base unit of its dimension (s, Hz, rad, m, V, A, ...).

    The value is an exact fraction, or a float if the factor of the unit is not exact (``deg``).  Raises
    :class:`QuantityError` for text that is not a quantity, a unit of another dimension, or a number without a unit.
    """
    units = units_of(dimension)
    wanted = f"{'an' if dimension[0] in 'aeiou' else 'a'} {dimension}"
    hint = f"write a number and a unit ({', '.join(units)})"
    if dimension == "ratio" and isinstance(value, (int, float)) and not isinstance(value, bool):
        return parse_ratio(value)
    if isinstance(value, (int, float)) and not isinstance(value, bool):
        if not math.isfinite(value):
            raise QuantityError(f"{value} is not {wanted}", hint)
        written = int(value) if value == int(value) and abs(value) < 1e15 else value
        example = f"write for example '{written} {base_unit(dimension)}'; units: {', '.join(units)}"
        raise QuantityError(f"this {dimension} has no unit", example, "wrong-unit")
    if not isinstance(value, str):
        raise QuantityError(f"this is not {wanted}", hint)
    if decimal_comma(value):
        raise QuantityError(f"'{value.strip()}' is written with a decimal comma", decimal_comma(value))
    match = _QUANTITY.fullmatch(value.strip()) if len(value) <= _LONGEST else None
    if not match or not _is_small(match[1]):
        shown = value if len(value) <= 60 else value[:57] + "..."
        raise QuantityError(f"'{shown}' is not {wanted}", hint)
    unit = normal_unit(match[2] or "")
    if unit not in UNITS or (not unit and dimension != "ratio"):
        if not unit:
            raise QuantityError(f"this {dimension} has no unit", hint, "wrong-unit")
        raise QuantityError(f"unknown unit '{unit}'", _unit_hint(unit, units), "wrong-unit")
    found, factor = UNITS[unit]
    if found != dimension:
        raise QuantityError(f"'{unit}' is a unit of {found}, not of {dimension}", hint, "wrong-unit")
    number = Fraction(match[1])
    return number * factor if isinstance(factor, Fraction) else float(number) * factor


def _is_small(number: str) -> bool:
    """True if the number and its exponent are short.  ``1e999999999`` would make an exact fraction of enormous size."""
    exponent = re.search(r"[eE][-+]?(\d+)$", number)
    return len(number) <= 64 and (exponent is None or (len(exponent[1]) <= 3 and int(exponent[1]) <= 300))


def _unit_hint(unit: str, units: list[str]) -> str:
    for known in units:
        if known.casefold() == unit.casefold():
            return f"did you mean '{known}'?"
    return f"units: {', '.join(units)}"
