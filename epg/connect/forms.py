# SPDX-License-Identifier: Apache-2.0
"""The settings of a target and the parameters of its components as forms: fields, and the values in the files.

A field comes from the JSON Schema by which ``epg check`` checks the value, so a form has the keys, limits and
descriptions of ``component.yaml``, ``middleware.yaml`` and ``schemas/tcf.schema.json``.  A value is a text as a user
writes it in a ``.tcf``, with the file and line that have it.

>>> # forms = forms_of(loaded, catalog, owns_tcf=True)
>>> # forms.values["components.pwm_pan.frequency"].text  ->  "20 kHz"
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

from epg.connect.form_fields import FieldPath, FieldSet, FormField, Forms, FormValue, KindForm, SettingsSection
from epg.connect.loaded import Loaded, value_at
from epg.edit.parameters import PARAMETERS, parameter_path
from epg.edit.scalars import scalar_text
from epg.generator.catalog.catalog import Catalog, Computer, Kind
from epg.generator.catalog.middleware import Middleware
from epg.generator.check.compose import communication_schema, component_schema, console_schema
from epg.generator.check.configuration import Component
from epg.generator.check.fail_safe import can_disable
from epg.generator.check.merge import merge_chain
from epg.generator.check.middleware import offered
from epg.generator.check.uses import possible_references
from epg.generator.diagnostics import Diagnostics
from epg.generator.documents.schema import load_schema
from epg.generator.documents.yaml_file import parse_yaml
from epg.generator.quantity import show, units_of
from epg.generator.source import Span, YamlNode

CONSOLE = "console"
_MOST_PARAMETERS = 300
"""The largest number of parameters of a model that get fields: each new state of the session has all fields."""
_CONVERSION = ("scale", "offset", "unit", "limits")
_ALL_INTEGERS = (str(-(1 << 31)), str((1 << 31) - 1))
_SCALARS = {"number": "number", "integer": "integer", "boolean": "boolean", "string": "text"}


def forms_of(loaded: Loaded, catalog: Catalog, *, owns_tcf: bool) -> Forms:
    """The forms of the target: those of all kinds of components, its settings, and all values."""
    root, target, components = loaded.tree, loaded.target, loaded.components
    if root is None:
        return Forms()
    kinds = {name: kind for name in catalog.kind_names() if (kind := catalog.find_kind(name)) is not None}
    kind_forms = {name: _kind_form(kind, target, components) for name, kind in kinds.items()}
    settings = [*_settings(root, target, components, catalog), *_parameters(loaded)]
    places = _Places(loaded, owns_tcf)
    values = places.values(("components", name) for name in _component_names(root))
    for section in settings:
        values |= places.values(field.path for field in section.fields)
    values |= _parameter_values(loaded)
    own = loaded.chain[0].node.get("components") if loaded.chain else None
    left_out = [name for name, node in own.items() if node.value is None] if own is not None else []
    return Forms(kind_forms, settings, values, left_out)


def _component_names(root: YamlNode) -> list[str]:
    section = root.get("components")
    return [name for name, _ in section.items()] if section is not None else []


# fields


def _kind_form(kind: Kind, target: Computer | None, components: Mapping[str, Component]) -> KindForm:
    schema = component_schema(kind, with_pins=target is not None and target.has_pins)
    properties = _values_of_kind(schema["properties"], kind, target, components)
    first = ("pins", *(use.name for use in kind.uses))
    keys = sorted(properties, key=lambda key: key not in first)
    fields = (_field((key,), properties[key], key in schema["required"]) for key in keys)
    one_of = [FieldSet(tuple(names), several=False) for names in kind.exactly_one]
    one_of += [FieldSet(tuple(names), several=True) for names in kind.at_least_one]
    shown = tuple(_field_of_kind(field, target) for field in fields)
    return KindForm(kind.group, kind.summary, shown, tuple(one_of), _unusable(kind, target))


def _field_of_kind(field: FormField, target: Computer | None) -> FormField:
    if field.path == ("pins",):
        pins = (replace(pin, type="pin", example=_pin_example(target)) for pin in field.fields)
        return replace(field, example="", fields=tuple(pins))
    return replace(field, section="Conversion of the value") if field.path[0] in _CONVERSION else field


def _values_of_kind(
    schemas: Mapping[str, Any], kind: Kind, target: Computer | None, components: Mapping[str, Component]
) -> dict[str, Any]:
    """The schemas of the values that a component of ``kind`` can have on this target, and the components to name."""
    values = {key: child for key, child in schemas.items() if key != "kind"}
    kinds = {name: each.kind for name, each in components.items()}
    for use in kind.uses:
        values[use.name] = {**values[use.name], "choices": possible_references(use, kinds)}
    if kind.claims and (target is None or not target.platform.has_nodes):
        del values["node"]
    if target is not None and not target.has_pins:
        values.pop("pins", None)
    return values


def _pin_example(target: Computer | None) -> str:
    return target.board.pin_title(target.board.pins[0]) if target is not None and target.board.pins else "10"


def _unusable(kind: Kind, target: Computer | None) -> str:
    if target is None:
        return ""
    lacking = dict.fromkeys(
        claim.resource_class for claim in kind.claims if target.resource_class(claim.resource_class) is None
    )
    return f"{target.name} does not offer: {', '.join(lacking)}" if lacking else ""


def _field(path: FieldPath, schema: Mapping[str, Any], required: bool = False) -> FormField:
    """A field for a value of ``schema``."""
    kind = _type_of(schema)
    below = schema["properties"] if kind == "group" else {}
    needed = schema.get("required", ())
    return FormField(
        path,
        kind,
        description=schema.get("description", ""),
        required=required,
        default=_text(schema["default"]) if schema.get("default") is not None else "",
        units=units_of(schema["x-quantity"]) if kind == "quantity" else (),
        choices=[_text(value) for value in schema["enum"]] if kind == "choice" else schema.get("choices"),
        limits=_limits(schema) if kind in ("number", "integer") else "",
        example=_text(schema["examples"][0]) if schema.get("examples") else "",
        fields=tuple(_field((*path, key), child, key in needed) for key, child in below.items()),
    )


def _limits(schema: Mapping[str, Any]) -> str:
    """The limits of a number in words; empty if its description has them, or if they are those of all integers."""
    low, high = (str(schema.get(key, "")) for key in ("minimum", "maximum"))
    if "(" in schema.get("description", "") or (low, high) == _ALL_INTEGERS:
        return ""
    if low and high:
        return f"{low} to {high}"
    return f"at least {low}" if low else f"at most {high}" if high else ""


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


# settings


def _settings(
    root: YamlNode, target: Computer | None, components: Mapping[str, Component], catalog: Catalog
) -> list[SettingsSection]:
    """The sections of a ``.tcf`` beside its components, with the keys that have an effect on this target."""
    whole = load_schema("tcf")["properties"]
    sections = [("Control loop", _below("control", _control(whole["control"], components)))]
    sections.append(("Communication", _communication(root, target, components, catalog)))
    sections.append(("ROS 2 node", {(key,): whole[key] for key in ("node", "namespace")}))
    if target is not None and not target.platform.simulates_plant and target.clocks:
        sections.append(("Clocks of the chip", _clocks(target)))
    return [
        SettingsSection(title, tuple(_field(path, schema, path == ("node",)) for path, schema in fields.items()))
        for title, fields in sections
    ]


def _parameters(loaded: Loaded) -> list[SettingsSection]:
    """The section with the parameters of the model, whose values are in the bindings; empty if there are too many."""
    model = loaded.parts.model
    if model is None or not 0 < len(model.parameters) <= _MOST_PARAMETERS:
        return []
    fields = []
    for parameter in model.parameters:
        unit = f"in {parameter.unit}" if parameter.unit else "without a unit"
        description = f"exported value {parameter.value:g}, {unit}"
        path = (PARAMETERS, parameter.name)
        fields.append(FormField(path, "number", description, default=repr(parameter.value)))
    return [SettingsSection("Parameters of the model", tuple(fields))]


def _parameter_values(loaded: Loaded) -> dict[str, FormValue]:
    values = {}
    for parameter in loaded.parts.model.parameters if loaded.parts.model is not None else ():
        node = loaded.root.get(*parameter_path(loaded.root, parameter.name)) if loaded.root is not None else None
        if node is not None:
            value = FormValue(_node_text(node), "own", node.span.file, node.span.line, own=True)
            values[f"{PARAMETERS}.{parameter.name}"] = value
    return values


def _below(section: str, schemas: Mapping[str, Any]) -> dict[FieldPath, Any]:
    return {(section, key): schema for key, schema in schemas.items()}


def _control(schema: Mapping[str, Any], components: Mapping[str, Component]) -> dict[str, Any]:
    able = [name for name, component in components.items() if can_disable(component.kind)]
    return {**schema["properties"], "fail_safe": {**schema["properties"]["fail_safe"], "choices": able}}


def _communication(
    root: YamlNode, target: Computer | None, components: Mapping[str, Component], catalog: Catalog
) -> dict[FieldPath, Any]:
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


def _without_effect(middleware: Middleware, target: Computer, offers: Mapping[str, object]) -> Iterator[str]:
    """The keys of ``communication`` that have no effect with ``middleware`` on ``target``."""
    if not middleware.is_node:
        yield from ("domain", "diagnostics", "keep_cycles")
    if "parameters" not in middleware.uses or not middleware.is_node:
        yield "parameters"
    if middleware.name == CONSOLE or CONSOLE not in offers:
        yield "console"
    if not target.platform.has_usb_names:
        yield "usb"


def _clocks(target: Computer) -> dict[FieldPath, Any]:
    schema = load_schema("tcf")["properties"]["clocks"]["additionalProperties"]
    clocks: dict[FieldPath, Any] = {}
    for name, clock in target.clocks.items():
        default = {"default": show(clock.frequency, "frequency")} if clock.frequency is not None else {}
        clocks["clocks", name] = {**schema, "description": clock.title, **default}
    return clocks


# values


class _Places:
    """The values of a target in its files.  ``below`` are the values without the target's own file."""

    def __init__(self, loaded: Loaded, owns_tcf: bool) -> None:
        self._root = loaded.tree
        self._own = loaded.chain[0].node if loaded.chain and owns_tcf else None
        self._below = merge_chain(loaded.chain[1:]) if len(loaded.chain) > 1 else None
        self._names = {str(file.path) for file in loaded.chain}
        self._own_file = str(loaded.chain[0].path) if loaded.chain and owns_tcf else ""
        self._roots = [root / "robots" for root in loaded.request.roots]

    def values(self, paths: Iterable[FieldPath]) -> dict[str, FormValue]:
        values: dict[str, FormValue] = {}
        for path in paths:
            self._add(path, values)
        return values

    def _add(self, path: FieldPath, values: dict[str, FormValue]) -> None:
        """The value at ``path``, and those below it."""
        node = value_at(self._root, *path)
        own = value_at(self._own, *path)
        below = value_at(self._below, *path)
        removed = own is not None and own.value is None
        stated = own if removed else node
        if stated is None:
            return
        value = self._value(node, self._span(path, stated))
        if own is not None:
            back = self._value(below, below.span) if below is not None else None
            value = replace(value, own=True, back=back, removed=removed)
        values[".".join(path)] = value
        keys = dict.fromkeys(key for each in (node, own) if each is not None for key, _ in each.items())
        for key in keys:
            self._add((*path, key), values)

    def _span(self, path: FieldPath, node: YamlNode) -> Span:
        above = value_at(self._root, *path[:-1])
        return above.key_span(path[-1]) if above is not None and path[-1] in above and node.is_mapping else node.span

    def _value(self, node: YamlNode | None, span: Span) -> FormValue:
        """The value of a node, or an empty one without a node, in the file and line of ``span``."""
        path = Path(span.file)
        if span.file == self._own_file:
            how = "own"
        elif span.file not in self._names:
            how = "call"
        else:
            how = "epg" if any(root in path.parents for root in self._roots) else "file"
        return FormValue(_node_text(node) if node is not None else "", how, span.file, span.line)


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


def value_of(field: FormField, text: str, refuse: Callable[[str], Exception]) -> object:
    """The value that ``text`` in a field means.  A number that is none stays a text, which ``epg check`` reports."""
    if field.type in ("yaml", "group"):
        problems = Diagnostics()
        node = parse_yaml(text, field.name, problems)
        if node is None or problems.has_errors:
            raise refuse(next(iter(problems)).message if problems.has_errors else "this is not YAML")
        return node.plain()
    if field.type == "boolean":
        return {"true": True, "false": False}.get(text, text)
    if field.type in ("number", "integer", "pin", "ratio", "choice"):
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
