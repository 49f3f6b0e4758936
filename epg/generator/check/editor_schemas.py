# SPDX-License-Identifier: Apache-2.0
"""The JSON Schemas for editors: complete schemas with all kinds and targets.

EPG itself checks a file in parts: with ``schemas/*.schema.json``, and each component with the schema of its kind.  An
editor has one schema for a file.  Therefore :func:`editor_schema` puts all parts into one schema, and uses only the
part of draft 2020-12 that editors understand:

- For each kind, ``if`` a component has this ``kind``, ``then`` the kind's schema applies.
- A pattern gives quantities the units of their dimension.
- ``null`` is possible everywhere, because in a ``.tcf`` it deletes a value of an extended file.
- Keys are required only in a file that is complete: one that names a ``target`` and has no ``extends``.  Robots and
  wirings, which other files extend, are not complete.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterable, Mapping
from typing import Any, TypeVar

from epg.generator.catalog.catalog import Catalog, Computer, Kind
from epg.generator.catalog.middleware import Middleware
from epg.generator.check.compose import communication_schema, component_schema
from epg.generator.check.middleware import needs_component, offered
from epg.generator.documents.schema import load_schema
from epg.generator.quantity import SPELLINGS, units_of

Definition = TypeVar("Definition")
EditorSchema = dict[str, Any]

USER_FILES = ("tcf", "bindings", "model", "scenario", "system")
TARGET_FILES = ("board", "class", "component", "family", "middleware", "platform", "soc", "tool")
_NUMBER = r"([0-9]+(\.[0-9]*)?|\.[0-9]+)([eE][-+]?[0-9]+)?"
_COMPLETE = {"required": ["target"], "not": {"required": ["extends"]}}


def editor_schema(name: str, catalog: Catalog, *, built_in: bool) -> EditorSchema:
    """The schema of the files of the sort ``name``, which is in :data:`USER_FILES` or :data:`TARGET_FILES`.

    ``built_in`` is True if the catalog has no folder of the user.  Only then the schema is the published one, and has
    its ``$id``.
    """
    schema = _plain(load_schema(name))
    if name == "tcf":
        schema = _tcf(schema, catalog)
    if built_in:
        schema["$id"] = schema["$id"].replace("/schemas/v1/", "/schemas/v1/editor/")
    else:
        del schema["$id"]
    return schema


def _tcf(schema: EditorSchema, catalog: Catalog) -> EditorSchema:
    """The schema of a ``.tcf`` with all kinds, targets and middlewares of the catalog."""
    kinds = _found(catalog.find_kind, catalog.kind_names())
    targets = _found(catalog.find_target, catalog.target_names())
    needed = _needs(schema)
    schema = _optional(schema)
    properties = schema["properties"]
    properties["version"] = load_schema("tcf")["properties"]["version"]
    properties["target"]["enum"] = [*(target.name for target in targets), None]
    properties["components"]["additionalProperties"] = {"$ref": "#/$defs/component"}
    needed.setdefault("properties", {})["components"] = {"additionalProperties": {"$ref": "#/$defs/complete"}}
    wired = {"properties": {"components": {"additionalProperties": {"$ref": "#/$defs/wired"}}}}
    without_pins = [target.name for target in targets if not target.has_pins]
    pins = {"not": {"properties": {"target": {"enum": without_pins}}}} if without_pins else True
    middlewares = _found(catalog.find_middleware, catalog.names("middleware"))
    options = {key for middleware in middlewares for key in communication_schema(middleware)["properties"]}
    properties["communication"]["propertyNames"] = {"enum": sorted(options)}
    schema["allOf"] = [
        {"if": _COMPLETE, "then": needed},
        {"if": {"allOf": [_COMPLETE, pins]}, "then": wired},
        *_clocks(targets),
        *_middlewares(targets, catalog, any(kind.transport for kind in kinds)),
        *_options(middlewares),
    ]
    schema["$defs"] = _components(kinds)
    return schema


def _found(find: Callable[[str], Definition | None], names: Iterable[str]) -> list[Definition]:
    """The items with these names.  An item with mistakes is left out."""
    return [item for name in names if (item := find(name)) is not None]


def _components(kinds: Iterable[Kind]) -> EditorSchema:
    """The definitions ``component``, ``complete`` and ``wired``, and the same three for each kind.

    ``complete`` and ``wired`` hold the keys that a component needs in a complete file, and on a target with pins.
    """
    kinds = list(kinds)
    definitions: EditorSchema = {}
    keys = {"kind"}
    for kind in kinds:
        whole, unwired = (_plain(component_schema(kind, with_pins=pins)) for pins in (True, False))
        keys |= set(whole["properties"])
        possible = _optional(unwired)
        possible["properties"]["kind"] = {"const": kind.name, "description": kind.summary}
        definitions[kind.name] = {key: value for key, value in possible.items() if key != "$schema"}
        definitions[f"{kind.name}-complete"] = _needs(unwired) | _relations(kind)
        definitions[f"{kind.name}-wired"] = _pins_needed(kind)
    listed = "; ".join(f"{kind.name}: {kind.summary}" for kind in kinds)
    component = {
        "type": ["object", "null"],
        "description": "a sensor, an actuator, a topic or a number",
        "properties": {"kind": {"enum": [kind.name for kind in kinds], "description": f"kind of component; {listed}"}},
        "propertyNames": {"enum": sorted(keys)},
        "allOf": [_if_kind(kind, kind.name) for kind in kinds],
    }
    complete = {"required": ["kind"], "allOf": [_if_kind(kind, f"{kind.name}-complete") for kind in kinds]}
    wired = {"allOf": [_if_kind(kind, f"{kind.name}-wired") for kind in kinds]}
    return {"component": component, "complete": complete, "wired": wired, **definitions}


def _if_kind(kind: Kind, definition: str) -> EditorSchema:
    return {
        "if": {"type": "object", "properties": {"kind": {"const": kind.name}}, "required": ["kind"]},
        "then": {"$ref": f"#/$defs/{definition}"},
    }


def _relations(kind: Kind) -> EditorSchema:
    """The relations between the keys of a kind: keys that exclude each other, and keys that need another one."""
    rules: list[EditorSchema] = [{"oneOf": [{"required": [name]} for name in names]} for names in kind.exactly_one]
    rules += [{"anyOf": [{"required": [name]} for name in names]} for names in kind.at_least_one]
    pairs = [pair for names in kind.at_most_one for pair in itertools.combinations(names, 2)]
    rules += [{"not": {"required": list(pair)}} for pair in pairs]
    relations: EditorSchema = {"allOf": rules} if rules else {}
    if kind.only_with:
        needs: dict[str, list[str]] = {}
        for key, needed in kind.only_with:
            needs.setdefault(key, []).append(needed)
        relations["dependentRequired"] = needs
    return relations


def _pins_needed(kind: Kind) -> EditorSchema:
    if not kind.pins:
        return {}
    wired: EditorSchema = {"required": ["pins"], "properties": {"pins": {"required": list(kind.pins)}}}
    return {"oneOf": [wired, {"required": ["node"]}]} if len(kind.claims) == 1 else wired


def _clocks(targets: Iterable[Computer]) -> list[EditorSchema]:
    """The names of the clocks of each chip, for files that name a target with it.  Simulations ignore other clocks."""
    names: dict[tuple[str, ...], list[str]] = {}
    for target in targets:
        if not target.platform.simulates_plant:
            names.setdefault(tuple(sorted(target.clocks)), []).append(target.name)
    return [
        {
            "if": {"properties": {"target": {"enum": chosen}}, "required": ["target"]},
            "then": {"properties": {"clocks": {"propertyNames": {"enum": list(clocks)}}}},
        }
        for clocks, chosen in names.items()
    ]


def _middlewares(targets: Iterable[Computer], catalog: Catalog, named: bool) -> list[EditorSchema]:
    """The middlewares and transports of each platform on each family of chips, for files that name such a target.

    ``named`` is True if a transport can also be the name of a component.
    """
    platforms: dict[str, list[Computer]] = {}
    for target in targets:
        family = target.platform.family
        offers = sorted(target.platform.middlewares.items())
        platforms.setdefault(f"{target.platform.name} {family.name if family else ''} {offers}", []).append(target)
    rules: list[EditorSchema] = []
    for group in platforms.values():
        possible = offered(group[0], catalog)
        chosen = {"properties": {"target": {"enum": [target.name for target in group]}}, "required": ["target"]}
        rules.append({"if": chosen, "then": _communication({"middleware": {"enum": [*possible, None]}})})
        for name, transports in possible.items():
            using = _communication({"middleware": {"const": name}}, required=["middleware"])
            stated: EditorSchema = {"enum": [*transports, None]}
            middleware = catalog.find_middleware(name)
            carried = middleware is not None and needs_component(middleware, group[0], transports)
            if named and (transports or carried):
                stated = {"anyOf": [stated, {"type": "string"}]}
            transport = _communication({"transport": stated})
            rules.append({"if": {"allOf": [chosen, using]}, "then": transport})
    return rules


def _options(middlewares: Iterable[Middleware]) -> list[EditorSchema]:
    """The options of each middleware, for files that name it.  In complete files, its required options are required."""
    rules: list[EditorSchema] = []
    for middleware in middlewares:
        whole = _plain(communication_schema(middleware))
        stated = _optional({"properties": {o.name: whole["properties"][o.name] for o in middleware.options}})
        using = _communication({"middleware": {"const": middleware.name}}, required=["middleware"])
        allowed = {**stated, "propertyNames": {"enum": sorted(whole["properties"])}}
        rules.append({"if": using, "then": {"properties": {"communication": allowed}}})
        if whole["required"]:
            needed = {"properties": {"communication": {"required": whole["required"]}}}
            rules.append({"if": {"allOf": [_COMPLETE, using]}, "then": needed})
    return rules


def _communication(properties: EditorSchema, required: Iterable[str] = ()) -> EditorSchema:
    required = list(required)
    inner = {"properties": properties, **({"required": required} if required else {})}
    return {"properties": {"communication": inner}, **({"required": ["communication"]} if required else {})}


def _plain(schema: EditorSchema) -> EditorSchema:
    """``schema`` without EPG's own annotations, and with exact patterns for quantities and ratios in their place."""

    def convert(value: Any) -> Any:
        if isinstance(value, list):
            return [convert(element) for element in value]
        if not isinstance(value, dict):
            return value
        result = {key: convert(child) for key, child in value.items() if not key.startswith("x-")}
        dimension = value.get("x-quantity")
        if isinstance(dimension, str):
            sign = "[-+]?" if "-+" in value.get("pattern", "") else ""
            result["pattern"] = _ratio_form(sign) if dimension == "ratio" else _quantity_form(dimension, sign)
        return result

    converted: EditorSchema = convert(schema)
    return converted


def _quantity_form(dimension: str, sign: str) -> str:
    """A regular expression of ECMA-262 for the texts that :func:`epg.generator.quantity.parse_quantity` accepts."""
    units = units_of(dimension)
    spellings = sorted(other for other, unit in SPELLINGS.items() if unit in units)
    alternatives = "|".join(unit.replace(".", r"\.") for unit in (*units, *spellings))
    return rf"^\s*{sign}{_NUMBER}\s*({alternatives})\s*$"


def _ratio_form(sign: str) -> str:
    return rf"^\s*{sign}{_NUMBER}\s*/\s*[-+]?{_NUMBER}\s*$"


def _optional(schema: Mapping[str, Any]) -> EditorSchema:
    """``schema`` without required keys, and with ``null`` as a possible value of every key."""
    result = {key: value for key, value in schema.items() if key != "required"}
    if "properties" in result:
        result["properties"] = {key: _nullable(child) for key, child in result["properties"].items()}
    return result


def _nullable(schema: Mapping[str, Any]) -> EditorSchema:
    result = _optional(schema)
    if "type" in result:
        types = [result["type"]] if isinstance(result["type"], str) else result["type"]
        result["type"] = [*types, *(["null"] if "null" not in types else [])]
    if "enum" in result:
        result["enum"] = [*result["enum"], None]
    return result


def _needs(schema: Mapping[str, Any]) -> EditorSchema:
    """Only the required keys of ``schema``, on all levels."""
    needs: EditorSchema = {"required": schema["required"]} if schema.get("required") else {}
    inner = {key: found for key, child in schema.get("properties", {}).items() if (found := _needs(child))}
    return needs | ({"properties": inner} if inner else {})
