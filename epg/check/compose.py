# SPDX-License-Identifier: Apache-2.0
"""Components as their kinds describe them: the JSON Schema of a component, and its parameters as typed values."""

from __future__ import annotations

import math
from collections.abc import Mapping
from fractions import Fraction
from types import MappingProxyType
from typing import Any

from epg.catalog.kind import Kind, KindParameter, make_parameter
from epg.catalog.middleware import Middleware
from epg.diagnostics import Diagnostics, Note, did_you_mean
from epg.documents.items import map_of, texts_of
from epg.documents.schema import extended_from, load_schema, validate
from epg.quantity import QuantityError, number_hint, parse_quantity, parse_ratio
from epg.source import Node, Span

COMMON_PARAMETERS = ("kind", "node", "scale", "offset", "unit", "limits")
"""Keys that every component has besides ``pins`` and the parameters of its kind."""

_WORDS = {
    "minimum": "at least",
    "exclusiveMinimum": "more than",
    "maximum": "at most",
    "exclusiveMaximum": "less than",
}
_NAME = {
    "type": "string",
    "pattern": "^[A-Za-z_][A-Za-z0-9_]*$",
    "maxLength": 63,
    "x-message": "is no name: use letters, digits and '_', at most 63, no digit first",
}
MOST_NAMES = 32
"""Most names of a list; epg/message.h has room for as many joints."""
_NODE = {
    "type": "string",
    "pattern": "^[A-Za-z_][A-Za-z0-9_]*$",
    "x-message": "is no label of a devicetree node: use letters, digits and '_', no digit first",
    "description": "label of a devicetree node that is used instead of pins (Zephyr)",
    "examples": ["qdec0"],
}
_PIN = {"type": ["integer", "string"], "minimum": 0, "description": "number or name of a pin"}


def component_schema(kind: Kind, with_pins: bool) -> dict[str, Any]:
    """The JSON Schema (draft 2020-12) of a component of ``kind``; on targets without pins they may be left out."""
    properties: dict[str, Any] = {"kind": {"const": kind.name, "description": kind.summary}}
    required = ["kind"]
    if kind.pins:
        properties["pins"] = {
            "type": "object",
            "description": "where it is wired to",
            "properties": {pin: dict(_PIN) for pin in kind.pins},
            "required": list(kind.pins) if with_pins else [],
            "additionalProperties": False,
            "examples": [{pin: number for number, pin in enumerate(kind.pins)}],
        }
        required += ["pins"] if with_pins else []
    if kind.claims:
        properties["node"] = _NODE
    for parameter in kind.parameters:
        properties[parameter.name] = _parameter_schema(parameter)
    for use in kind.uses:
        properties[use.name] = {"type": "string", "minLength": 1, "description": use.description}
        if use.examples:
            properties[use.name]["examples"] = list(use.examples)
    required += [use.name for use in kind.uses if use.required]
    properties |= load_schema("bindings")["$defs"]["conversion"]
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": kind.name,
        "description": kind.summary,
        "type": "object",
        "properties": properties,
        "required": required + [parameter.name for parameter in kind.parameters if parameter.required],
        "additionalProperties": False,
    }


def communication_schema(middleware: Middleware) -> dict[str, Any]:
    """The JSON Schema of ``communication`` with ``middleware``: the keys of every one, and its options."""
    common = load_schema("tcf")["properties"]["communication"]
    options = {option.name: _parameter_schema(option) for option in middleware.options}
    return {
        "type": "object",
        "properties": {**common["properties"], **options},
        "required": [option.name for option in middleware.options if option.required],
        "additionalProperties": False,
    }


def options_schema(middleware: Middleware) -> dict[str, Any]:
    """The JSON Schema of a map of the options of ``middleware`` alone, as for a console beside another one."""
    return {
        "type": "object",
        "properties": {option.name: _parameter_schema(option) for option in middleware.options},
        "required": [option.name for option in middleware.options if option.required],
        "additionalProperties": False,
    }


def typed_options(middleware: Middleware, node: Node | None, diagnostics: Diagnostics) -> Mapping[str, object]:
    """The options in a map that has passed one of the schemas above, typed as :func:`typed_parameters` does."""
    values = {
        option.name: _typed(option, node.get(option.name) if node is not None else None, diagnostics)
        for option in middleware.options
    }
    return MappingProxyType(values)


def typed_parameters(kind: Kind, node: Node, diagnostics: Diagnostics) -> Mapping[str, object]:
    """The parameters of a component that has passed :func:`component_schema`; problems with values are reported.

    Quantities are in base units (s, Hz, rad, ...) and, like ratios, exact fractions unless their unit is not; other
    numbers are floats, integers stay; ``pins`` maps names to pins as written.  Parameters that are not stated have
    their default, or None.
    """
    _relations(kind, node, diagnostics)
    values: dict[str, object] = {}
    for parameter in kind.parameters:
        values[parameter.name] = _typed(parameter, node.get(parameter.name), diagnostics)
    pins = node.get("pins")
    values["pins"] = MappingProxyType({pin: child.value for pin, child in pins.items()} if pins else {})
    return MappingProxyType(values)


def parameter_problems(name: str, node: Node, span: Span, diagnostics: Diagnostics) -> None:
    """Reports what is wrong with the description of a parameter in a kind: its type, bounds and default."""
    if ("type" in node) == ("quantity" in node):
        hint = "'quantity' is for numbers with a unit"
        diagnostics.error("exactly-one", span, f"parameter '{name}' states either 'type' or 'quantity'", hint=hint)
        return
    nested = "type" in node and node["type"].value == "object"
    if nested != ("properties" in node):
        message = (
            f"parameter '{name}' is an object without 'properties'" if nested else "only an object has 'properties'"
        )
        diagnostics.error("wrong-value", span, message)
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
            diagnostics.error("wrong-value", parameter.default.span, "a parameter with a default is not required")
        if validate(parameter.default, _parameter_schema(parameter), diagnostics):
            _typed(parameter, parameter.default, diagnostics)


def _alias_problems(node: Node, diagnostics: Diagnostics) -> None:
    """Each alias is another way to write one value of the parameter's enum, which has texts."""
    values = texts_of(node, "enum") if "type" in node and node["type"].value == "string" else ()
    for alias, meant in map_of(node, "aliases").items():
        if alias in values:
            message = f"'{alias}' is a value of 'enum' itself"
            diagnostics.error("wrong-value", node["aliases"].key_span(alias), message)
        if meant.value not in values:
            message = f"'enum' has no text '{meant.value}'"
            diagnostics.error("unknown-name", meant.span, message, hint=did_you_mean(str(meant.value), values))


def _parameter_schema(parameter: KindParameter) -> dict[str, Any]:
    schema: dict[str, Any] = {"description": _description(parameter), **parameter.keywords}
    if parameter.aliases:
        schema["enum"] = [*schema["enum"], *parameter.aliases]
    if parameter.default is not None:
        schema["default"] = parameter.default.plain()
    if parameter.type == "quantity":
        schema |= {"type": "string", "x-quantity": parameter.dimension, "pattern": "^\\s*[-+]?[0-9.]"}
    elif parameter.type == "ratio":
        schema |= {"type": ["number", "string"], "x-quantity": "ratio", "pattern": "^\\s*[-+]?[0-9.]"}
    elif parameter.type == "object":
        properties = {child.name: _parameter_schema(child) for child in parameter.properties}
        schema |= {"type": "object", "properties": properties, "additionalProperties": False}
        schema["required"] = [child.name for child in parameter.properties if child.required]
        examples = {
            child.name: child.keywords["examples"][0] for child in parameter.properties if "examples" in child.keywords
        }
        if examples:
            schema.setdefault("examples", [examples])
    elif parameter.type == "names":
        schema |= {"type": "array", "items": _NAME, "minItems": 1, "maxItems": MOST_NAMES, "uniqueItems": True}
    else:
        schema["type"] = parameter.type
        if parameter.type == "integer" and "enum" not in schema:  # an int of C, unless the kind says otherwise
            lowest, highest = ("minimum", -(1 << 31)), ("maximum", (1 << 31) - 1)
            stated = {word.lower().removeprefix("exclusive") for word in parameter.bounds}
            schema |= {key: limit for key, limit in (lowest, highest) if key not in stated}
        schema |= {key: bound.plain() for key, bound in parameter.bounds.items()}
    return schema


def _description(parameter: KindParameter) -> str:
    bounds = [f"{_WORDS[key]} {bound.value}" for key, bound in parameter.bounds.items()]
    return f"{parameter.description} ({', '.join(bounds)})" if bounds else parameter.description


def _typed(parameter: KindParameter, node: Node | None, diagnostics: Diagnostics) -> object:
    stated = node if node is not None else parameter.default
    if stated is None:
        return None
    if parameter.type == "object":
        values = {child.name: _typed(child, stated.get(child.name), diagnostics) for child in parameter.properties}
        return MappingProxyType(values)
    if parameter.type == "names":
        return tuple(str(element.value) for element in stated.elements())
    try:
        value = _value(parameter, stated.value)
    except QuantityError as problem:
        id = "wrong-unit" if "unit" in str(problem) else "wrong-quantity"
        diagnostics.error(id, stated.span, str(problem), hint=problem.hint, notes=extended_from(stated))
        return None
    if isinstance(value, float) and not math.isfinite(value):
        diagnostics.error("wrong-value", stated.span, "this number is not finite", notes=extended_from(stated))
    elif parameter.type in ("quantity", "ratio"):
        _check_bounds(parameter, value, stated, diagnostics)
    return value


def _value(parameter: KindParameter, written: object) -> Fraction | float | int | str | bool:
    """The typed value of what is written; raises :class:`QuantityError`."""
    if parameter.type == "quantity":
        return parse_quantity(written, parameter.dimension)
    if parameter.type == "ratio":
        return parse_ratio(written)
    if parameter.type == "number" and isinstance(written, (int, float)) and not isinstance(written, bool):
        try:
            return float(written)
        except OverflowError:
            return math.inf
    if parameter.type == "number":
        raise QuantityError(f"'{written}' is not a number", number_hint(str(written)))
    if parameter.type == "integer":
        if isinstance(written, bool) or not isinstance(written, (int, float)) or written != int(written):
            raise QuantityError(f"'{written}' is not a whole number")
        return int(written)
    assert isinstance(written, (str, bool))
    return parameter.aliases.get(written, written) if isinstance(written, str) else written


def _check_bounds(parameter: KindParameter, value: object, node: Node, diagnostics: Diagnostics) -> None:
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
            message = f"'{node.value}' is out of range: must be {_WORDS[key]} {bound.value}"
            diagnostics.error("out-of-range", node.span, message, notes=extended_from(node))


def _relations(kind: Kind, node: Node, diagnostics: Diagnostics) -> None:
    span = node["kind"].span
    for names in kind.exactly_one:
        stated = [name for name in names if name in node]
        if not stated:
            message = f"a {kind.name} states {_alternatives(names)}"
            hint = _descriptions(kind, names)
            diagnostics.error("exactly-one", span, message, hint=hint, notes=extended_from(node["kind"]))
        elif len(stated) > 1:
            first = Note("the other one", node.key_span(stated[0]))
            message = f"a {kind.name} states {_alternatives(names)}, not several of them"
            notes = [first, *extended_from(node[stated[1]])]
            hint = (
                "remove one of the two; '" + stated[0] + ": null' removes one that a file this one extends has written"
            )
            diagnostics.error("exactly-one", node.key_span(stated[1]), message, hint=hint, notes=notes)
    for names in kind.at_least_one:
        if not any(name in node for name in names):
            message = f"a {kind.name} states at least one of {', '.join(repr(name) for name in names)}"
            hint = _descriptions(kind, names)
            diagnostics.error("at-least-one", span, message, hint=hint, notes=extended_from(node["kind"]))
    for names in kind.at_most_one:
        stated = [name for name in names if name in node]
        if len(stated) > 1:
            first = Note("the other one", node.key_span(stated[0]))
            message = f"a {kind.name} states at most one of {', '.join(repr(name) for name in names)}"
            notes = [first, *extended_from(node[stated[1]])]
            hint = f"remove one of the two; '{stated[0]}: null' removes one that a file this one extends has written"
            diagnostics.error("at-most-one", node.key_span(stated[1]), message, hint=hint, notes=notes)
    for key, needed in kind.only_with:
        if key in node and needed not in node:
            message = f"'{key}' means something only together with '{needed}'"
            hint = f"remove '{key}', or state '{needed}'"
            diagnostics.error("only-with", node.key_span(key), message, hint=hint, notes=extended_from(node[key]))


def _descriptions(kind: Kind, names: tuple[str, ...]) -> str:
    described = [(parameter.name, parameter.description) for parameter in kind.parameters]
    described += [(use.name, use.description) for use in kind.uses]
    return "; ".join(f"{name}: {description}" for name, description in described if name in names)


def _alternatives(names: tuple[str, ...]) -> str:
    quoted = [f"'{name}'" for name in names]
    start = "either " if len(names) == 2 else "exactly one of "
    return start + (" or ".join(quoted) if len(names) == 2 else ", ".join(quoted))
