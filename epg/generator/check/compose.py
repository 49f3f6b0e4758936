# SPDX-License-Identifier: Apache-2.0
"""Makes the JSON Schema of a component from its kind, and typed values from its parameters.

Does the same for the options of middlewares.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from types import MappingProxyType
from typing import Any

from epg.generator.catalog.kind import Kind
from epg.generator.catalog.middleware import Middleware
from epg.generator.catalog.parameter import parameter_schema, typed_value
from epg.generator.diagnostics import Diagnostics, Note, nearest
from epg.generator.documents.items import map_of, text_map_of
from epg.generator.documents.schema import extended_from, load_schema
from epg.generator.source import YamlNode

_NODE = {
    "type": "string",
    "pattern": "^[A-Za-z_][A-Za-z0-9_]*$",
    "x-message": "is not a label of a devicetree node: use letters, digits and '_', and do not begin with a digit",
    "description": "label of a devicetree node that is used instead of pins (Zephyr)",
    "examples": ["qdec0"],
}
_SHORTEST = 3
"""The length of the shortest beginning of a pin's name that means the pin."""
_PIN = {"type": ["integer", "string"], "minimum": 0, "description": "number or name of a pin"}


def component_schema(kind: Kind, with_pins: bool) -> dict[str, Any]:
    """The JSON Schema (draft 2020-12) of a component of ``kind``.  It requires ``pins`` only with ``with_pins``."""
    properties: dict[str, Any] = {"kind": {"const": kind.name, "description": kind.summary}}
    required = ["kind"]
    if kind.pins:
        properties["pins"] = {
            "type": "object",
            "description": "the pins to which it is wired",
            "properties": {pin: dict(_PIN) for pin in kind.pins},
            "required": list(kind.pins) if with_pins else [],
            "additionalProperties": False,
            "examples": [{pin: number for number, pin in enumerate(kind.pins)}],
        }
        required += ["pins"] if with_pins else []
    if kind.claims:
        properties["node"] = _NODE
    for parameter in kind.parameters:
        properties[parameter.name] = parameter_schema(parameter)
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
        "x-instead": dict(text_map_of(kind.node["instead"])) if "instead" in kind.node else {},
    }


def with_hints(schema: dict[str, Any], kind: Kind, node: YamlNode, kinds: Iterable[Kind]) -> dict[str, Any]:
    """``schema`` with a hint for each written pin that ``kind`` does not have, but another one of ``kinds``.

    That kind must have all pins that ``node`` names.  ``direction`` is meant as ``direction_a`` and ``direction_b``.
    """
    written = list(map_of(node, "pins"))
    foreign = [pin for pin in written if not _has_pin(kind, pin) and not nearest(pin, kind.pins)]
    fitting = [other for other in kinds if all(_has_pin(other, pin) for pin in written)] if foreign else []
    if not fitting:
        return schema
    hint = "; or ".join(f"write 'kind: {other.name}', {other.summary}" for other in fitting)
    described = {**schema["properties"]["pins"], "x-instead": dict.fromkeys(foreign, hint)}
    return {**schema, "properties": {**schema["properties"], "pins": described}}


def _has_pin(kind: Kind, written: str) -> bool:
    """True if ``kind`` has a pin of this name, or several pins whose names begin with it."""
    beginning = [pin for pin in kind.pins if pin.startswith(written)] if len(written) >= _SHORTEST else []
    return written in kind.pins or len(beginning) > 1


def communication_schema(middleware: Middleware) -> dict[str, Any]:
    """The JSON Schema of ``communication`` with ``middleware``: the keys of all middlewares, and its own options."""
    options = options_schema(middleware)
    common = load_schema("tcf")["properties"]["communication"]["properties"]
    return {**options, "properties": {**common, **options["properties"]}}


def options_schema(middleware: Middleware) -> dict[str, Any]:
    """The JSON Schema of a map with the options of ``middleware`` only."""
    return {
        "type": "object",
        "properties": {option.name: parameter_schema(option) for option in middleware.options},
        "required": [option.name for option in middleware.options if option.required],
        "additionalProperties": False,
    }


def console_schema(console: Middleware) -> dict[str, Any]:
    """The JSON Schema of ``communication.console``: the options of a console beside another middleware."""
    options = options_schema(console)
    transport = {
        "type": "string",
        "minLength": 1,
        "description": "the component that carries its bytes, such as a uart",
    }
    return {**options, "properties": {"transport": transport, **options["properties"]}}


def typed_options(middleware: Middleware, node: YamlNode | None, diagnostics: Diagnostics) -> Mapping[str, object]:
    """The options in a map that fits one of the two schemas above, with the types of :func:`typed_parameters`."""
    values = {
        option.name: typed_value(option, node.get(option.name) if node is not None else None, diagnostics)
        for option in middleware.options
    }
    return MappingProxyType(values)


def typed_parameters(kind: Kind, node: YamlNode, diagnostics: Diagnostics) -> Mapping[str, object]:
    """The parameters of a component that fits :func:`component_schema`.  Reports wrong values.

    Quantities are in base units (s, Hz, rad, ...).  Quantities and ratios are exact fractions, or floats if the factor
    of the unit is not exact.  The type ``number`` gives a float, ``integer`` an int.  A parameter
    that is not stated has its default, or None.
    """
    _relations(kind, node, diagnostics)
    values: dict[str, object] = {}
    for parameter in kind.parameters:
        values[parameter.name] = typed_value(parameter, node.get(parameter.name), diagnostics)
    return MappingProxyType(values)


def _relations(kind: Kind, node: YamlNode, diagnostics: Diagnostics) -> None:
    """Reports keys of a component that its kind does not allow together, and keys that it requires together."""
    for names in kind.exactly_one:
        _at_least_one("exactly-one", _alternatives(names), names, kind, node, diagnostics)
        _at_most_one("exactly-one", f"{_alternatives(names)}, not more than one of them", names, node, diagnostics)
    for names in kind.at_least_one:
        _at_least_one("at-least-one", f"at least one of {_quoted(names)}", names, kind, node, diagnostics)
    for names in kind.at_most_one:
        _at_most_one("at-most-one", f"at most one of {_quoted(names)}", names, node, diagnostics)
    for key, needed in kind.only_with:
        if key in node and needed not in node:
            message = f"'{key}' has an effect only together with '{needed}'"
            hint = f"remove '{key}', or set '{needed}'"
            diagnostics.error("only-with", node.key_span(key), message, hint=hint, notes=extended_from(node[key]))


def _at_least_one(
    id: str, what: str, names: tuple[str, ...], kind: Kind, node: YamlNode, diagnostics: Diagnostics
) -> None:
    if not any(name in node for name in names):
        described = [(parameter.name, parameter.description) for parameter in kind.parameters]
        described += [(use.name, use.description) for use in kind.uses]
        hint = "; ".join(f"{name}: {description}" for name, description in described if name in names)
        message = f"a {kind.name} must set {what}"
        diagnostics.error(id, node["kind"].span, message, hint=hint, notes=extended_from(node["kind"]))


def _at_most_one(id: str, what: str, names: tuple[str, ...], node: YamlNode, diagnostics: Diagnostics) -> None:
    stated = [name for name in names if name in node]
    if len(stated) > 1:
        notes = [Note("the other one", node.key_span(stated[0])), *extended_from(node[stated[1]])]
        message = f"a {node['kind'].value} must set {what}"
        hint = f"remove one of the two ('{stated[0]}: null' if an extended file has set it)"
        diagnostics.error(id, node.key_span(stated[1]), message, hint=hint, notes=notes)


def _alternatives(names: tuple[str, ...]) -> str:
    return "either " + " or ".join(map(repr, names)) if len(names) == 2 else f"exactly one of {_quoted(names)}"


def _quoted(names: tuple[str, ...]) -> str:
    return ", ".join(map(repr, names))
