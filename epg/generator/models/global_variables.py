# SPDX-License-Identifier: Apache-2.0
"""The global variables of an export that each start must reset to their initial values."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from fractions import Fraction

from epg.generator.models.assignments import exact_number, finite
from epg.generator.models.c_code import Variable, integer_value
from epg.generator.models.code_parts import GlobalVariable

_FLOATING = ("double", "float")
_BASE_TYPES = {"double", "float", "int", "char", "short", "long", "unsigned", "signed char", "unsigned char", "bool"}


def base_type(name: str, types: Mapping[str, str]) -> str:
    """The type of C that a typedef such as ``XXDouble`` names; empty if it is not a plain type.

    ``types`` are the typedefs: name to type.
    """
    for _ in range(4):
        if name in _BASE_TYPES:
            return name
        name = types.get(name, "")
    return ""


def global_variables(
    variables: Iterable[Variable], types: Mapping[str, str], macros: dict[str, str]
) -> tuple[GlobalVariable, ...]:
    """The variables that a start can reset, sorted by name.

    They are scalars of a plain type whose initial value is a number, and arrays of a plain type without initial values.
    Constants and pointers are left out.
    """
    found = (_resettable(variable, types, macros) for variable in sorted(variables, key=lambda variable: variable.name))
    return tuple(variable for variable in found if variable is not None)


def _resettable(variable: Variable, types: Mapping[str, str], macros: dict[str, str]) -> GlobalVariable | None:
    """The variable with its initial value, or None if a start cannot reset it."""
    base = base_type(variable.type, types)
    if not base or variable.constant or variable.pointer:
        return None
    if variable.dimensions:
        count = _elements(variable, macros)
        return GlobalVariable(variable.name, base, count, "") if count and not variable.initializer else None
    value = exact_number(variable.initializer or "0")
    if value is None or finite(value) is None or (base not in _FLOATING and abs(value) >= 1 << 31):
        return None
    return GlobalVariable(variable.name, base, 0, _value(value, base))


def _elements(variable: Variable, macros: dict[str, str]) -> int:
    total = 1
    for size in re.findall(r"\[([^\]]*)\]", variable.dimensions):
        total *= integer_value(size, macros) or 0
    return total


def _value(value: Fraction, base: str) -> str:
    return repr(float(value)) if base in _FLOATING else str(int(value))
