# SPDX-License-Identifier: Apache-2.0
"""The settings of a target and the parameters of its components as forms: fields, and the values in the files.

A field comes from the JSON Schema by which ``epg check`` checks the value, so a form has the keys, limits and
descriptions of ``component.yaml``, ``middleware.yaml`` and ``schemas/tcf.schema.json``.  A value is a text as a user
writes it in a ``.tcf``, with the file and line that have it.

>>> # forms = forms_of(loaded, catalog, owns_tcf=True)
>>> # forms["values"]["components.pwm_pan.frequency"]["text"]  ->  "20 kHz"
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from epg.catalog.catalog import Catalog, Kind, Target
from epg.catalog.middleware import Middleware
from epg.check.compose import communication_schema, component_schema, console_schema
from epg.check.configuration import Component
from epg.check.fail_safe import can_disable
from epg.check.merge import merge_chain
from epg.check.middleware import offered
from epg.check.uses import possible_references
from epg.connect.loaded import Loaded
from epg.diagnostics import Diagnostics
from epg.documents.schema import load_schema
from epg.documents.tcf import TcfFile
from epg.documents.yaml_file import parse_yaml
from epg.edit.parameters import PARAMETERS, parameter_path
from epg.edit.scalars import scalar_text
from epg.quantity import show, units_of
from epg.source import Span, YamlNode

Data = dict[str, Any]
Path_ = tuple[str, ...]

CONSOLE = "console"
_MOST_PARAMETERS = 300
"""The largest number of parameters of a model that get fields: each new state of the session has all fields."""
_CONVERSION = ("scale", "offset", "unit", "limits")
_SCALARS = {"number": "number", "integer": "integer", "boolean": "boolean", "string": "text"}


def forms_of(loaded: Loaded, catalog: Catalog, *, owns_tcf: bool) -> Data:
    """The forms of the target: ``kinds`` with the fields of their components, ``settings``, and all ``values``.

    The keys of ``values`` are the keys in the ``.tcf``, joined by dots.  A value that no file has is missing there:
    the ``default`` of its field holds.  ``left_out`` are the inherited components that the own file removes.
    """
    root, target, components = loaded.tree, loaded.target, loaded.components
    if root is None:
        return {"kinds": {}, "settings": [], "values": {}, "left_out": []}
    kinds = {name: kind for name in catalog.kind_names() if (kind := catalog.find_kind(name)) is not None}
    kind_forms = {name: _kind_form(kind, target, components) for name, kind in kinds.items()}
    settings = [*_settings(root, target, components, catalog), *_parameters(loaded)]
    places = _Places(loaded, owns_tcf)
    values = places.values(("components", name) for name in _component_names(root))
    for section in settings:
        values |= places.values(tuple(field["path"]) for field in section["fields"])
    values |= _parameter_values(loaded)
    own = loaded.chain[0].node.get("components") if loaded.chain else None
    left_out = [name for name, node in own.items() if node.value is None] if own is not None else []
    return {"kinds": kind_forms, "settings": settings, "values": values, "left_out": left_out}


def _component_names(root: YamlNode) -> list[str]:
    section = root.get("components")
    return [name for name, _ in section.items()] if section is not None else []


# fields


def _kind_form(kind: Kind, target: Target | None, components: Mapping[str, Component]) -> Data:
    """The form of a component of ``kind``: paths are those below the component.

    ``one_of`` are sets of fields of which a component must set one, or ``several`` of them.  ``unusable`` says why the
    target cannot have such a component, and is empty if it can.
    """
    schema = component_schema(kind, with_pins=target is not None and target.has_pins)
    properties = {key: child for key, child in schema["properties"].items() if key != "kind"}
    for use in kind.uses:
        properties[use.name] = {
            **properties[use.name],
            "choices": possible_references(use, {name: each.kind for name, each in components.items()}),
        }
    if kind.claims and (target is None or not target.platform.has_nodes):
        del properties["node"]
    if target is not None and not target.has_pins:
        properties.pop("pins", None)
    first = ("pins", *(use.name for use in kind.uses))
    keys = sorted(properties, key=lambda key: key not in first)
    fields = [_field((key,), properties[key], key in schema["required"]) for key in keys]
    for field in fields:
        if field["path"] == ["pins"]:
            field.pop("example", None)
            for pin in field["fields"]:
                pin |= {"type": "pin", "example": _pin_example(target)}
        if field["path"][0] in _CONVERSION:
            field["section"] = "Conversion of the value"
    return {
        "group": kind.group,
        "summary": kind.summary,
        "fields": fields,
        "one_of": [
            *({"names": list(names), "several": False} for names in kind.exactly_one),
            *({"names": list(names), "several": True} for names in kind.at_least_one),
        ],
        "unusable": _unusable(kind, target),
    }


def _pin_example(target: Target | None) -> str:
    return target.board.pin_title(target.board.pins[0]) if target is not None and target.board.pins else "10"


def _unusable(kind: Kind, target: Target | None) -> str:
    if target is None:
        return ""
    lacking = dict.fromkeys(
        claim.resource_class for claim in kind.claims if target.resource_class(claim.resource_class) is None
    )
    return f"{target.name} does not offer: {', '.join(lacking)}" if lacking else ""


def _field(path: Path_, schema: Mapping[str, Any], required: bool = False) -> Data:
    """A field for a value of ``schema``.  Keys without a value are left out."""
    kind = _type_of(schema)
    field: Data = {"path": list(path), "name": path[-1], "type": kind, "description": schema.get("description", "")}
    if required:
        field["required"] = True
    if schema.get("default") not in (None, ""):
        field["default"] = _text(schema["default"])
    if "x-quantity" in schema and schema["x-quantity"] != "ratio":
        field["units"] = units_of(schema["x-quantity"])
    if "enum" in schema:
        field["choices"] = [_text(value) for value in schema["enum"]]
    elif "choices" in schema:
        field["choices"] = schema["choices"]
    limits = [str(schema[key]) if key in schema else "" for key in ("minimum", "maximum")]
    if kind in ("number", "integer") and any(limits) and "(" not in field["description"]:
        low, high = limits
        words = f"{low} to {high}" if low and high else f"at least {low}" if low else f"at most {high}"
        field["limits"] = words if (low, high) != (str(-(1 << 31)), str((1 << 31) - 1)) else ""
    if schema.get("examples"):
        field["example"] = _text(schema["examples"][0])
    if kind == "group":
        wanted = schema.get("required", ())
        field["fields"] = [_field((*path, key), child, key in wanted) for key, child in schema["properties"].items()]
    return {key: value for key, value in field.items() if value != ""}


def _type_of(schema: Mapping[str, Any]) -> str:
    """The type of the field of a value: "yaml" if the value can be a list, a map, or of several types."""
    if "choices" in schema:
        return "reference"
    if "enum" in schema:
        return "choice"
    if "x-quantity" in schema:
        return "ratio" if schema["x-quantity"] == "ratio" else "quantity"
    if schema.get("type") == "object" and "properties" in schema:
        return "group"
    return _SCALARS.get(str(schema.get("type")), "yaml")


def field_at(forms: Data, path: Sequence[str]) -> Data | None:
    """The field of the value at ``path``; None if the target has no such field."""
    fields = [field for section in forms["settings"] for field in section["fields"]]
    wanted = list(path)
    if path[0] == "components" and len(path) > 2:
        kind = forms["values"].get(f"components.{path[1]}.kind", {}).get("text", "")
        fields = forms["kinds"][kind]["fields"] if kind in forms["kinds"] else []
        wanted = wanted[2:]
    return next((field for field in _flat(fields) if field["path"] == wanted), None)


def _flat(fields: Iterable[Data]) -> Iterator[Data]:
    for field in fields:
        yield field
        yield from _flat(field.get("fields", ()))


# settings


def _settings(
    root: YamlNode, target: Target | None, components: Mapping[str, Component], catalog: Catalog
) -> list[Data]:
    """The sections of a ``.tcf`` beside its components, with the keys that have an effect on this target."""
    whole = load_schema("tcf")["properties"]
    sections = [("Control loop", _below("control", _control(whole["control"], components)))]
    sections.append(("Communication", _communication(root, target, components, catalog)))
    sections.append(("ROS 2 node", {(key,): whole[key] for key in ("node", "namespace")}))
    if target is not None and not target.platform.simulates_plant and target.clocks:
        sections.append(("Clocks of the chip", _clocks(target)))
    return [
        {"title": title, "fields": [_field(path, schema, path == ("node",)) for path, schema in fields.items()]}
        for title, fields in sections
    ]


def _parameters(loaded: Loaded) -> list[Data]:
    """The section with the parameters of the model, whose values are in the bindings; empty if there are too many."""
    model = loaded.parts.model
    if model is None or not 0 < len(model.parameters) <= _MOST_PARAMETERS:
        return []
    fields = []
    for parameter in model.parameters:
        field = {"path": [PARAMETERS, parameter.name], "name": parameter.name, "type": "number"}
        unit = f"in {parameter.unit}" if parameter.unit else "without a unit"
        field |= {"description": f"exported value {parameter.value:g}, {unit}", "default": repr(parameter.value)}
        fields.append(field)
    return [{"title": "Parameters of the model", "fields": fields}]


def _parameter_values(loaded: Loaded) -> Data:
    found: Data = {}
    for parameter in loaded.parts.model.parameters if loaded.parts.model is not None else ():
        node = loaded.root.get(*parameter_path(loaded.root, parameter.name)) if loaded.root is not None else None
        if node is not None:
            place = {"how": "own", "file": node.span.file, "line": node.span.line, "own": True}
            found[f"{PARAMETERS}.{parameter.name}"] = {"text": _node_text(node), **place}
    return found


def _below(section: str, schemas: Mapping[str, Any]) -> dict[Path_, Any]:
    return {(section, key): schema for key, schema in schemas.items()}


def _control(schema: Mapping[str, Any], components: Mapping[str, Component]) -> dict[str, Any]:
    able = [name for name, component in components.items() if can_disable(component.kind)]
    return {**schema["properties"], "fail_safe": {**schema["properties"]["fail_safe"], "choices": able}}


def _communication(
    root: YamlNode, target: Target | None, components: Mapping[str, Component], catalog: Catalog
) -> dict[Path_, Any]:
    if target is None:
        return _below("communication", load_schema("tcf")["properties"]["communication"]["properties"])
    offers = offered(target, catalog)
    written = root.get("communication", "middleware")
    default = next(iter(target.platform.middlewares), "none")
    name = str(written.value) if written is not None and written.value in offers else default
    middleware = catalog.find_middleware(name)
    if middleware is None:
        return {}
    schemas = dict(communication_schema(middleware)["properties"])
    schemas["middleware"] = {**schemas["middleware"], "enum": list(offers), "default": default}
    carriers = [name for name, component in components.items() if component.kind.transport]
    transports = [*offers.get(name, ()), *carriers]
    if middleware.connection == "stream" and transports:
        schemas["transport"] = {**schemas["transport"], "enum": transports, "default": transports[0]}
        schemas["transport"]["description"] = "the link that carries its bytes"
    else:
        del schemas["transport"]
    for key in _without_effect(middleware, target, offers):
        schemas.pop(key, None)
    console = catalog.find_middleware(CONSOLE)
    if "console" in schemas and console is not None and root.get("communication", "console", "transport") is not None:
        schemas["console"] = {**console_schema(console), "description": schemas["console"]["description"]}
    return _below("communication", schemas)


def _without_effect(middleware: Middleware, target: Target, offers: Mapping[str, object]) -> Iterator[str]:
    """The keys of ``communication`` that have no effect with ``middleware`` on ``target``."""
    if not middleware.is_node:
        yield from ("domain", "diagnostics", "keep_cycles")
    if "parameters" not in middleware.uses or not middleware.is_node:
        yield "parameters"
    if middleware.name == CONSOLE or CONSOLE not in offers:
        yield "console"
    if not target.platform.has_usb_names:
        yield "usb"


def _clocks(target: Target) -> dict[Path_, Any]:
    schema = load_schema("tcf")["properties"]["clocks"]["additionalProperties"]
    found: dict[Path_, Any] = {}
    for name, clock in target.clocks.items():
        default = {"default": show(clock.frequency, "frequency")} if clock.frequency is not None else {}
        found["clocks", name] = {**schema, "description": clock.title, **default}
    return found


# values


class _Places:
    """The values of a target in its files.  ``below`` are the values without the target's own file."""

    def __init__(self, loaded: Loaded, owns_tcf: bool) -> None:
        self._chain: Sequence[TcfFile] = loaded.chain
        self._root = loaded.tree
        self._own = loaded.chain[0].node if loaded.chain and owns_tcf else None
        self._below = merge_chain(loaded.chain[1:]) if len(loaded.chain) > 1 else None
        self._names = {str(file.path) for file in loaded.chain}
        self._own_file = str(loaded.chain[0].path) if loaded.chain and owns_tcf else ""
        self._roots = [root / "robots" for root in loaded.request.roots]

    def values(self, paths: Iterable[Path_]) -> Data:
        found: Data = {}
        for path in paths:
            self._add(path, found)
        return found

    def _add(self, path: Path_, found: Data) -> None:
        """The value at ``path``, and those below it."""
        node = self._root.get(*path) if self._root is not None else None
        own = self._own.get(*path) if self._own is not None else None
        below = self._below.get(*path) if self._below is not None else None
        if node is None and own is None:
            return
        entry: Data = {"text": _node_text(node) if node is not None else ""}
        stated = own if own is not None and own.value is None else node
        assert stated is not None
        entry |= self._origin(self._span(path, stated))
        if own is not None:
            entry["own"] = True
            if below is not None:
                entry["back"] = {"text": _node_text(below), **self._origin(below.span)}
        if own is not None and own.value is None:
            entry["removed"] = True
        found[".".join(path)] = entry
        keys = dict.fromkeys(key for each in (node, own) if each is not None for key, _ in each.items())
        for key in keys:
            self._add((*path, key), found)

    def _span(self, path: Path_, node: YamlNode) -> Span:
        above = self._root.get(*path[:-1]) if self._root is not None else None
        return above.key_span(path[-1]) if above is not None and path[-1] in above and node.is_mapping else node.span

    def _origin(self, span: Span) -> Data:
        """The file and line of a value.  ``how`` is "own", "file", "epg", or "call" for an argument in CMake."""
        path = Path(span.file)
        if span.file == self._own_file:
            how = "own"
        elif span.file not in self._names:
            how = "call"
        else:
            how = "epg" if any(root in path.parents for root in self._roots) else "file"
        return {"how": how, "file": span.file, "line": span.line}


def _node_text(node: YamlNode) -> str:
    return _text(node.plain())


def _text(value: object) -> str:
    """A value as a user writes it: a text without quotes, or a list or map on one line."""
    return value if isinstance(value, str) else _flow(value)


def _flow(value: object) -> str:
    if isinstance(value, Mapping):
        return "{" + ", ".join(f"{_flow(key)}: {_flow(child)}" for key, child in value.items()) + "}"
    if isinstance(value, (list, tuple)):
        return "[" + ", ".join(map(_flow, value)) + "]"
    return scalar_text(value)


def value_of(field: Data, text: str, refuse: Callable[[str], Exception]) -> object:
    """The value that ``text`` in a field means.  A number that is none stays a text, which ``epg check`` reports."""
    if field["type"] in ("yaml", "group"):
        problems = Diagnostics()
        node = parse_yaml(text, field["name"], problems)
        if node is None or problems.has_errors:
            raise refuse(next(iter(problems)).message if problems.has_errors else "this is not YAML")
        return node.plain()
    if field["type"] == "boolean":
        return {"true": True, "false": False}.get(text, text)
    if field["type"] in ("number", "integer", "pin", "ratio", "choice"):
        return _number(text)
    return text


def _number(text: str) -> object:
    for convert in (int, float):
        try:
            value = convert(text)
        except ValueError:
            continue
        return value if math.isfinite(value) and "_" not in text else text
    return text
