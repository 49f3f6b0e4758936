# SPDX-License-Identifier: Apache-2.0
"""Checks documents against a JSON Schema and reports violations as diagnostics with file, line and key.

:func:`validate` runs jsonschema on the plain form of a tree of :class:`~epg.generator.source.YamlNode` and turns every
violation into a diagnostic at the value, or key, that is wrong.  EPG's schemas have annotations for these diagnostics,
which other validators ignore:

``x-quantity``
    The dimension of a string such as ``20 kHz``.  :mod:`epg.generator.quantity` explains what is wrong with the text.
``x-message``
    The message for a value that does not match a pattern or any of several alternatives.
``x-hint``
    The hint that goes with ``x-message``.
``x-instead``
    Hints for keys that do not exist but that users are likely to write.
"""

from __future__ import annotations

import json
import re
from collections.abc import Mapping
from fractions import Fraction
from functools import cache
from pathlib import Path as FilePath
from typing import Any

from epg.generator.correction import Correction, KeyValue, correction
from epg.generator.data import data_folder
from epg.generator.diagnostics import Diagnostics, Note, did_you_mean, nearest, underscored
from epg.generator.documents.accept import accepts
from epg.generator.quantity import QuantityError, number_hint, parse_quantity, parse_ratio
from epg.generator.source import KeyPath, Span, YamlNode

_TYPE_NAMES = {
    "object": "a map (key: value)",
    "array": "a list",
    "string": "text",
    "number": "a number",
    "integer": "a whole number",
    "boolean": "true or false",
    "null": "nothing",
}


@cache
def load_schema(name: str) -> dict[str, Any]:
    """The schema ``schemas/<name>.schema.json``."""
    path: FilePath = data_folder("schemas") / f"{name}.schema.json"
    schema: dict[str, Any] = json.loads(path.read_text(encoding="utf-8"))
    return schema


def validate(
    node: YamlNode,
    schema: Mapping[str, Any],
    diagnostics: Diagnostics,
    *,
    partial: bool = False,
    known: Mapping[str, str] | None = None,
) -> bool:
    """Reports all parts of ``node`` that ``schema`` does not allow.  Returns True if ``node`` fits the schema.

    ``partial`` is for a file that extends another one: missing keys are not reported, and every value may be ``null``,
    which deletes its key.  ``known`` are values for keys of the file for which no other value is right.
    """
    plain = node.plain()
    if accepts(plain, schema, partial=partial):
        return True
    from jsonschema import Draft202012Validator

    good = True
    errors = Draft202012Validator(schema).iter_errors(plain)
    for error in sorted(errors, key=lambda e: ([str(step) for step in e.absolute_path], str(e.validator))):
        if partial and (error.validator in ("required", "dependentRequired") or error.instance is None):
            continue
        good = False
        _report(error, node, diagnostics, known or {})
    return good


def quantity_of(node: YamlNode, dimension: str, diagnostics: Diagnostics) -> Fraction | float | None:
    """The quantity of ``node`` in the base unit of its dimension; None after reporting that it is not one."""
    try:
        return parse_quantity(node.value, dimension)
    except QuantityError as problem:
        diagnostics.error(problem.id, node.span, str(problem), hint=problem.hint)
        return None


def extended_from(node: YamlNode) -> list[Note]:
    """A note for each ``extends`` that leads to the file in which ``node`` is written."""
    return [Note("extended here", span) for span in node.origins]


class _Violation:
    """A part ``node`` of the document ``root`` that does not fit ``schema``; ``error`` is jsonschema's description."""

    def __init__(self, error: Any, root: YamlNode) -> None:
        self.error = error
        self.root = root
        self.path: KeyPath = tuple(error.absolute_path)
        self.node = root.get(*self.path) or root
        self.schema: Mapping[str, Any] = error.schema if isinstance(error.schema, dict) else {}
        self.notes = extended_from(self.node)

    @property
    def unknown_keys(self) -> list[str]:
        return [key for key, _ in self.node.items() if key not in self.schema.get("properties", {})]


def _report(error: Any, root: YamlNode, diagnostics: Diagnostics, known_values: Mapping[str, str]) -> None:
    """Reports one violation that jsonschema has found: at the key for unknown and missing keys, else at the value."""
    broken = _Violation(error, root)
    keyword = str(error.validator)
    if "propertyNames" in error.absolute_schema_path:
        _report_name(broken, keyword, diagnostics)
        return
    fitting = _fitting_alternative(error) if keyword in ("anyOf", "oneOf") else []
    for violation in fitting:
        _report(violation, root, diagnostics, known_values)
    if fitting:
        return
    if keyword == "additionalProperties":
        for key in broken.unknown_keys:
            hint = broken.schema.get("x-instead", {}).get(key) or _unknown_key_hint(key, broken.node, broken.schema)
            _unknown_key(broken, key, hint, diagnostics)
    elif keyword in ("required", "dependentRequired"):
        _report_missing(broken, diagnostics, known_values)
    else:
        id, message, hint = _explain(keyword, error, broken.schema)
        diagnostics.error(id, broken.node.span, message, hint=hint, notes=broken.notes)


def _report_name(violation: _Violation, keyword: str, diagnostics: Diagnostics) -> None:
    """Reports a key that is not one of the possible names, or does not have the form of a name."""
    name, schema, node = str(violation.error.instance), violation.schema, violation.node
    if keyword == "enum":
        _unknown_key(violation, name, did_you_mean(name, violation.error.validator_value, "known keys"), diagnostics)
        return
    near = underscored(name)
    possible = near not in node and re.search(schema.get("pattern", ""), near) is not None
    hint = f"write '{near}'" if possible and len(near) <= schema.get("maxLength", len(near)) else ""
    hint = hint or str(schema.get("x-hint", ""))
    message = f"'{name}' {schema.get('x-message', 'is not a valid name')}"
    diagnostics.error("invalid-name", node.key_span(name), message, hint=hint, notes=violation.notes)


def _unknown_key(violation: _Violation, key: str, hint: str, diagnostics: Diagnostics) -> None:
    message = f"unknown key '{key}'{_where(violation.path)}"
    diagnostics.error("unknown-key", violation.node.key_span(key), message, hint=hint, notes=violation.notes)


def _report_missing(violation: _Violation, diagnostics: Diagnostics, known_values: Mapping[str, str]) -> None:
    """Reports missing keys, each with its value if only one is right."""
    schema, path, root = violation.schema, violation.path, violation.root
    # A missing key whose misspelt form is reported as an unknown key needs no second error.
    misspelt = {did_you_mean(key, _known_keys(schema)) for key in violation.unknown_keys}
    span = _owner_span(root, path)
    for key in _required(violation.error):
        if key in violation.node or f"did you mean '{key}'?" in misspelt:
            continue
        hint = _key_hint(key, schema)
        value = known_values.get(key, schema.get("properties", {}).get(key, {}).get("const"))
        if value is not None and not path:
            hint = KeyValue(f"write '{key}: {value}'", root.span.file, (key,), value)
        about = ".".join(map(str, (*path, key)))
        message = f"'{key}' is missing{_where(path)}"
        diagnostics.error("missing-key", span, message, hint=hint, notes=violation.notes, about=about)


BOUND_WORDS = {
    "minimum": "at least",
    "exclusiveMinimum": "more than",
    "maximum": "at most",
    "exclusiveMaximum": "less than",
}


def _explain(keyword: str, error: Any, schema: Mapping[str, Any]) -> tuple[str, str, str]:
    """Id, message and hint for a wrong value; missing and unknown keys are reported elsewhere."""
    value, limit = error.instance, error.validator_value
    quantity = _explain_quantity(keyword, value, schema)
    if quantity is not None:
        return quantity
    if "x-message" in schema and keyword in ("pattern", "anyOf", "oneOf", "not"):
        return "wrong-value", f"{_shown(value)} {schema['x-message']}", str(schema.get("x-hint", ""))
    if keyword == "pattern":
        return "wrong-value", f"{_shown(value)} does not have the required form", _form(schema)
    if keyword == "type":
        wanted = [limit] if isinstance(limit, str) else list(limit)
        names = " or ".join(_TYPE_NAMES.get(name, name) for name in wanted)
        return "wrong-type", f"expected {names}, found {_shown(value)}", _type_hint(value, wanted, schema)
    if keyword in ("anyOf", "oneOf"):
        hint = "write the value after ':'" if value is None else ""
        return "wrong-type", f"expected {_kinds_of(limit)}, found {_shown(value)}", hint
    if keyword in BOUND_WORDS:
        message = f"{_shown(value)} is out of range: must be {BOUND_WORDS[keyword]} {limit}"
        return "out-of-range", message, _bound_hint(keyword, value, limit, schema)
    return _explain_limit(keyword, value, limit)


def _kinds_of(alternatives: list[Any]) -> str:
    """The types of the values that one of the ``alternatives`` of a schema allows."""
    kinds = [_TYPE_NAMES.get(str(option.get("type")), "") for option in alternatives if isinstance(option, dict)]
    return " or ".join(dict.fromkeys(kind for kind in kinds if kind)) or "something else"


def _explain_quantity(keyword: str, value: object, schema: Mapping[str, Any]) -> tuple[str, str, str] | None:
    """Id, message and hint for a wrong quantity; None for another mistake."""
    if "x-quantity" not in schema or keyword not in ("type", "pattern", "anyOf", "oneOf"):
        return None
    try:
        if schema["x-quantity"] == "ratio":
            parse_ratio(value)
        else:
            parse_quantity(value, schema["x-quantity"])
    except QuantityError as problem:
        return problem.id, str(problem), problem.hint
    if keyword == "pattern":
        return "out-of-range", f"{_shown(value)} must not have a sign", "write the number without a sign"
    return None


def _explain_limit(keyword: str, value: object, limit: Any) -> tuple[str, str, str]:
    """Id, message and hint for a value of the right type that is not among the possible values."""
    if keyword == "enum":
        return "wrong-value", f"{_shown(value)} is not possible here", did_you_mean(str(value), map(str, limit))
    if keyword == "const":
        quoted = isinstance(value, str) and value.strip() == str(limit)
        hint = correction(str(value), str(limit), "write {} without quotes", bare=True) if quoted else ""
        return "wrong-value", f"expected {_shown(limit)}, found {_shown(value)}", hint
    if keyword == "uniqueItems":
        return "wrong-value", "this list has the same value twice", "remove one of the two"
    if keyword in ("minItems", "maxItems") and isinstance(value, list) and value:
        return "wrong-value", *_wrong_number(keyword, value, limit)
    if keyword in ("minProperties", "minItems", "minLength"):
        return "wrong-value", "this must not be empty", ""
    return "wrong-value", f"{_shown(value)} is not possible here ({keyword} {limit})", ""


def _wrong_number(keyword: str, values: list[Any], limit: object) -> tuple[str, str]:
    """Message and hint for a list with too many or too few ``values``."""
    bound = "at least" if keyword == "minItems" else "at most"
    comma = keyword == "maxItems" and all(isinstance(item, (int, float)) for item in values)
    hint = "write 1.5 instead of 1,5: a comma begins the next number" if comma else ""
    return f"expected {bound} {limit} values, found {len(values)}", hint


def _bound_hint(keyword: str, value: object, limit: object, schema: Mapping[str, Any]) -> str:
    """The hint for a number that is out of range: the key for the other sign, or the part that a percentage means."""
    if isinstance(value, (int, float)) and value < 0 and "x-below-zero" in schema:
        return str(schema["x-below-zero"])
    if isinstance(value, int) and 1 < value <= 100 and (keyword, limit) == ("maximum", 1):
        return f"{value} % is {value / 100:g}"
    return ""


def _fitting_alternative(error: Any) -> list[Any]:
    """The violations of the alternative that the user probably means: the first one that allows the value's type."""
    alternatives: dict[object, list[Any]] = {}
    for violation in error.context:
        alternatives.setdefault(violation.relative_schema_path[0], []).append(violation)
    for violations in alternatives.values():
        if not any(v.validator in ("type", "const", "enum") and not v.relative_path for v in violations):
            return violations
    return []


def _form(schema: Mapping[str, Any]) -> str:
    """The hint for a pattern without ``x-message``: the description and an example.  Parameters of kinds have both."""
    example = next((f", for example '{example}'" for example in schema.get("examples", ())), "")
    return f"{schema.get('description', '')}{example}"


def _type_hint(value: object, wanted: list[str], schema: Mapping[str, Any]) -> str:
    """The hint for a value of a wrong type: the right form of what is written, or an example of the key."""
    if isinstance(value, str):
        return _text_hint(value, wanted, schema)
    if isinstance(value, list) and "object" in wanted:
        return "write 'name: value' for each entry, without '-' and without [ ]"
    if isinstance(value, list) and "string" in wanted and len(value) == 1:
        return f"write {value[0]} without [ ]"
    if {"array", "object"} & set(wanted):
        return f"write for example {_flow(schema['examples'][0])}" if schema.get("examples") else ""
    if "string" in wanted and isinstance(value, (int, float, bool)):
        return "put it in quotes if it is meant as text"
    return ""


def _text_hint(text: str, wanted: list[str], schema: Mapping[str, Any]) -> str:
    """The hint for a text in place of a value of another type."""
    if "boolean" in wanted and text.casefold() in ("on", "off", "yes", "no", "y", "n"):
        meant = "true" if text.casefold() in ("on", "yes", "y") else "false"
        return correction(text, meant, "write {}: YAML 1.2 has only true and false", bare=True)
    if {"number", "integer"} & set(wanted):
        return number_hint(text)
    if "object" in wanted:
        key = re.match(r"([A-Za-z_]\w*)\s*[=\s:]", text)
        return f"write ':' after each key, for example '{key[1]}: ...'" if key else ""
    if "array" in wanted and schema.get("items", {}).get("type") == "string":
        return correction(text, f"[{text}]", "write {}: a list can have several entries", bare=True)
    return ""


def _flow(value: object) -> str:
    """An example as it is written in YAML on one line."""
    if isinstance(value, dict):
        return "{" + ", ".join(f"{key}: {_flow(each)}" for key, each in value.items()) + "}"
    if isinstance(value, list):
        return "[" + ", ".join(map(_flow, value)) + "]"
    return str(value) if isinstance(value, str) else json.dumps(value)


def _shown(value: object) -> str:
    """A value in a message: text in quotes and shortened, maps and lists by their type."""
    if isinstance(value, str):
        return f"'{value if len(value) <= 60 else value[:57] + '...'}'"
    if isinstance(value, bool):
        return "true" if value else "false"
    if value is None:
        return "nothing"
    if isinstance(value, dict):
        return "a map"
    if isinstance(value, list):
        return "a list"
    return str(value)


def _unknown_key_hint(key: str, node: YamlNode, schema: Mapping[str, Any]) -> str:
    """The hint for an unknown key: a similar one that its file does not set yet.

    It proposes no key that needs a map in place of another value.
    """
    known = _known_keys(schema)
    if any(near in node and node.key_span(near).file == node.key_span(key).file for near in nearest(key, known)):
        known = [name for name in known if name not in node]
    hint = did_you_mean(key, known, "known keys")
    if not isinstance(hint, Correction):
        return hint
    wants_map = schema["properties"][hint.new].get("type") == "object"
    return str(hint) if wants_map and not node[key].is_mapping else hint


def _known_keys(schema: Mapping[str, Any]) -> list[str]:
    return sorted(schema.get("properties", {}))


def _required(error: Any) -> list[str]:
    value = error.validator_value
    if isinstance(value, list):
        return [str(key) for key in value]
    return [str(key) for keys in value.values() for key in keys]


def _key_hint(key: str, schema: Mapping[str, Any]) -> str:
    described = schema.get("properties", {}).get(key, {})
    examples = described.get("examples")
    if examples:
        return f"write for example '{key}: {examples[0] if isinstance(examples[0], str) else json.dumps(examples[0])}'"
    return str(described.get("description", ""))


def _where(path: KeyPath) -> str:
    return f" in '{'.'.join(map(str, path))}'" if path else ""


def _owner_span(root: YamlNode, path: KeyPath) -> Span:
    """The position of the key whose value is the map at ``path``."""
    if not path:
        return root.span
    above = root.get(*path[:-1])
    if above is not None and isinstance(path[-1], str):
        return above.key_span(path[-1])
    node = root.get(*path)
    return node.span if node else root.span
