# SPDX-License-Identifier: Apache-2.0
"""Parameters of kinds and middlewares: their JSON Schema, their typed values, and mistakes in their descriptions."""

from __future__ import annotations

import math
from fractions import Fraction
from types import MappingProxyType
from typing import Any

from epg.generator.catalog.kind import KindParameter, make_parameter
from epg.generator.diagnostics import Diagnostics
from epg.generator.documents.items import map_of, text_of, texts_of
from epg.generator.documents.schema import BOUND_WORDS, extended_from, validate
from epg.generator.quantity import QuantityError, number_hint, parse_quantity, parse_ratio
from epg.generator.source import Span, YamlNode

COMMON_PARAMETERS = ("kind", "node", "scale", "offset", "unit", "limits")
"""Keys that every component can have, in addition to ``pins`` and the parameters of its kind."""

_NAME = {
    "type": "string",
    "pattern": "^[A-Za-z_][A-Za-z0-9_]*$",
    "maxLength": 63,
    "x-message": "is not a valid name: use at most 63 letters, digits and '_', and do not begin with a digit",
}
_CONSTANT = "is not a number, a text, true or false, or a list of them"
MOST_ELEMENTS = 1024
"""The largest number of elements in a constant of a message."""
MOST_NAMES = 32
"""The largest number of names in a list.  epg/message.h has room for as many joints."""


_CONSTANTS = {"type": ["number", "string", "boolean"]}
_FIXED: dict[str, dict[str, Any]] = {
    "ratio": {"type": ["number", "string"], "x-quantity": "ratio", "pattern": "^\\s*[-+]?[0-9.]"},
    "message": {"type": "string", "minLength": 1, "maxLength": 255},
    "fields": {
        "type": "object",
        "additionalProperties": {
            "anyOf": [_CONSTANTS, {"type": "array", "items": _CONSTANTS, "maxItems": MOST_ELEMENTS}],
            "x-message": _CONSTANT,
        },
    },
    "names": {"type": "array", "items": _NAME, "minItems": 1, "maxItems": MOST_NAMES, "uniqueItems": True},
}
"""The JSON Schemas of the types whose schema does not depend on the parameter."""


def parameter_problems(name: str, node: YamlNode, span: Span, diagnostics: Diagnostics) -> None:
    """Reports mistakes in the description of a parameter: in its type, bounds, aliases and default."""
    if not _has_type(name, node, span, diagnostics):
        return
    if "properties" in node:
        for child, described in node["properties"].items():
            parameter_problems(child, described, node["properties"].key_span(child), diagnostics)
    errors = diagnostics.error_count
    _alias_problems(node, diagnostics)
    if diagnostics.error_count > errors:
        return
    parameter = make_parameter(name, node, span)
    for bound in parameter.bounds.values():
        try:
            _value(parameter, bound.value)
        except QuantityError as problem:
            diagnostics.error("wrong-value", bound.span, str(problem), hint=problem.hint)
    if parameter.default is not None and diagnostics.error_count == errors:
        if parameter.required:
            diagnostics.error("wrong-value", parameter.default.span, "a parameter with a default must not be required")
        if validate(parameter.default, parameter_schema(parameter), diagnostics):
            typed_value(parameter, parameter.default, diagnostics)


def _has_type(name: str, node: YamlNode, span: Span, diagnostics: Diagnostics) -> bool:
    """True if a parameter has one type, and properties if it is an object; else False after reporting it."""
    if ("type" in node) == ("quantity" in node):
        hint = "'quantity' is for numbers with a unit"
        diagnostics.error("exactly-one", span, f"parameter '{name}' must set either 'type' or 'quantity'", hint=hint)
        return False
    nested = text_of(node, "type") == "object"
    if nested == ("properties" in node):
        return True
    needs = f"parameter '{name}' is an object and must have 'properties'"
    diagnostics.error("wrong-value", span, needs if nested else "only an object can have 'properties'")
    return False


def _alias_problems(node: YamlNode, diagnostics: Diagnostics) -> None:
    """Reports wrong aliases.  An alias is another way to write one text of the parameter's ``enum``."""
    values = texts_of(node, "enum") if "type" in node and node["type"].value == "string" else ()
    for alias, meant in map_of(node, "aliases").items():
        if alias in values:
            message = f"'{alias}' is already a value of 'enum'"
            diagnostics.error("wrong-value", node["aliases"].key_span(alias), message)
        message = f"'enum' has no value '{meant.value}'"
        diagnostics.known_or_error("unknown-name", meant.span, message, meant.value, values)


def parameter_schema(parameter: KindParameter) -> dict[str, Any]:
    """The JSON Schema of a value of ``parameter``."""
    schema: dict[str, Any] = {"description": _description(parameter), **parameter.keywords}
    if parameter.aliases:
        schema["enum"] = [*schema["enum"], *parameter.aliases]
    if parameter.default is not None:
        schema["default"] = parameter.default.plain()
    if parameter.type == "quantity":
        schema |= {"type": "string", "x-quantity": parameter.dimension, "pattern": "^\\s*[-+]?[0-9.]"}
    elif parameter.type == "object":
        schema |= _object_schema(parameter)
    elif parameter.type in _FIXED:
        schema |= _FIXED[parameter.type]
    else:
        schema |= _scalar_schema(parameter)
    return schema


def _object_schema(parameter: KindParameter) -> dict[str, Any]:
    """The keywords of a parameter with properties; the example has the examples of the properties."""
    children = parameter.properties
    schema: dict[str, Any] = {
        "type": "object",
        "properties": {child.name: parameter_schema(child) for child in children},
        "additionalProperties": False,
        "required": [child.name for child in children if child.required],
    }
    examples = {child.name: child.keywords["examples"][0] for child in children if "examples" in child.keywords}
    if examples and "examples" not in parameter.keywords:
        schema["examples"] = [examples]
    return schema


def _scalar_schema(parameter: KindParameter) -> dict[str, Any]:
    """The keywords of a number, a text or a boolean."""
    schema: dict[str, Any] = {"type": parameter.type}
    if parameter.type == "integer" and "enum" not in parameter.keywords:
        # Without bounds of the kind, it must fit an int of C.
        lowest, highest = ("minimum", -(1 << 31)), ("maximum", (1 << 31) - 1)
        stated = {word.lower().removeprefix("exclusive") for word in parameter.bounds}
        schema |= {key: limit for key, limit in (lowest, highest) if key not in stated}
    return schema | {key: bound.plain() for key, bound in parameter.bounds.items()}


def _description(parameter: KindParameter) -> str:
    bounds = [f"{BOUND_WORDS[key]} {bound.value}" for key, bound in parameter.bounds.items()]
    return f"{parameter.description} ({', '.join(bounds)})" if bounds else parameter.description


def typed_value(parameter: KindParameter, node: YamlNode | None, diagnostics: Diagnostics) -> object:
    """The value of ``node``, or the default if ``node`` is None; None if there is no default either.

    :func:`epg.generator.check.compose.typed_parameters` describes the types.  Reports values that are wrong or out of
    range.
    """
    stated = node if node is not None else parameter.default
    if stated is None:
        return None
    if parameter.type == "object":
        values = {child.name: typed_value(child, stated.get(child.name), diagnostics) for child in parameter.properties}
        return MappingProxyType(values)
    if parameter.type == "fields":
        return stated.plain()
    if parameter.type == "names":
        return tuple(str(element.value) for element in stated.elements())
    try:
        value = _value(parameter, stated.value)
    except QuantityError as problem:
        diagnostics.error(problem.id, stated.span, str(problem), hint=problem.hint, notes=extended_from(stated))
        return None
    if isinstance(value, float) and not math.isfinite(value):
        diagnostics.error("wrong-value", stated.span, "this number must be finite", notes=extended_from(stated))
    elif parameter.type in ("quantity", "ratio"):
        _check_bounds(parameter, value, stated, diagnostics)
    return value


def _value(parameter: KindParameter, written: object) -> Fraction | float | int | str | bool:
    """The typed value of a scalar as it is written.  Raises :class:`QuantityError`."""
    if parameter.type == "quantity":
        return parse_quantity(written, parameter.dimension)
    if parameter.type == "ratio":
        return parse_ratio(written)
    if parameter.type == "number":
        return _number(written)
    if parameter.type == "integer":
        if isinstance(written, bool) or not isinstance(written, (int, float)) or written != int(written):
            raise QuantityError(f"'{written}' is not a whole number")
        return int(written)
    assert isinstance(written, (str, bool))
    return parameter.aliases.get(written, written) if isinstance(written, str) else written


def _number(written: object) -> float:
    """The nearest double of a number as it is written.  Raises :class:`QuantityError`."""
    if isinstance(written, bool) or not isinstance(written, (int, float)):
        raise QuantityError(f"'{written}' is not a number", number_hint(str(written)))
    try:
        return float(written)
    except OverflowError:
        return math.inf


def _check_bounds(parameter: KindParameter, value: object, node: YamlNode, diagnostics: Diagnostics) -> None:
    assert isinstance(value, (int, float, Fraction))
    for key, bound in parameter.bounds.items():
        limit = _value(parameter, bound.value)
        assert isinstance(limit, (int, float, Fraction))
        within = {
            "minimum": value >= limit,
            "exclusiveMinimum": value > limit,
            "maximum": value <= limit,
            "exclusiveMaximum": value < limit,
        }
        if not within[key]:
            message = f"'{node.value}' is out of range: must be {BOUND_WORDS[key]} {bound.value}"
            hint = str(parameter.keywords.get("x-below-zero", "")) if value < 0 else ""
            diagnostics.error("out-of-range", node.span, message, hint=hint, notes=extended_from(node))
