# SPDX-License-Identifier: Apache-2.0
"""Checks documents against a JSON Schema and reports violations as diagnostics with file, line and key.

:func:`validate` runs jsonschema on the plain form of a tree of :class:`~epg.source.YamlNode` and turns every violation
into a diagnostic at the value, or key, that is wrong.  EPG's schemas have annotations for these diagnostics, which
other validators ignore:

``x-quantity``
    The dimension of a string such as ``20 kHz``.  :mod:`epg.quantity` explains what is wrong with the text.
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

from epg.data import data_folder
from epg.diagnostics import Diagnostics, Note, did_you_mean
from epg.documents.accept import accepts
from epg.quantity import QuantityError, number_hint, parse_quantity, parse_ratio
from epg.source import Path, Span, YamlNode

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


def validate(node: YamlNode, schema: Mapping[str, Any], diagnostics: Diagnostics, *, partial: bool = False) -> bool:
    """Reports all parts of ``node`` that ``schema`` does not allow.  Returns True if ``node`` fits the schema.

    ``partial`` is for a file that extends another one: missing keys are not reported, and every value may be ``null``,
    which deletes its key.
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
        _report(error, node, diagnostics)
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


# One function, because it is a list of cases: one for each keyword that needs a position or hint of its own.
def _report(error: Any, root: YamlNode, diagnostics: Diagnostics) -> None:
    """Reports one violation that jsonschema has found: at the key for unknown and missing keys, else at the value."""
    path: Path = tuple(error.absolute_path)
    node = root.get(*path) or root
    schema = error.schema if isinstance(error.schema, dict) else {}
    notes = extended_from(node)
    keyword = str(error.validator)
    if "propertyNames" in error.absolute_schema_path:
        if keyword == "enum":
            hint = did_you_mean(str(error.instance), error.validator_value, "known keys")
            message = f"unknown key '{error.instance}'{_where(path)}"
            diagnostics.error("unknown-key", node.key_span(str(error.instance)), message, hint=hint, notes=notes)
            return
        message = f"'{error.instance}' {schema.get('x-message', 'is not a valid name')}"
        hint = str(schema.get("x-hint", ""))
        diagnostics.error("invalid-name", node.key_span(str(error.instance)), message, hint=hint, notes=notes)
        return
    if keyword in ("anyOf", "oneOf"):
        fitting = _fitting_alternative(error)
        for violation in fitting:
            _report(violation, root, diagnostics)
        if fitting:
            return
    if keyword == "additionalProperties":
        known = _known_keys(schema)
        for key in (key for key, _ in node.items() if key not in schema.get("properties", {})):
            message = f"unknown key '{key}'" + _where(path)
            hint = schema.get("x-instead", {}).get(key) or did_you_mean(key, known, "known keys")
            diagnostics.error("unknown-key", node.key_span(key), message, hint=hint, notes=notes)
        return
    if keyword in ("required", "dependentRequired"):
        known = _known_keys(schema)
        unknown = [key for key, _ in node.items() if key not in schema.get("properties", {})]
        # A missing key whose misspelt form is reported as an unknown key needs no second error.
        misspelt = {did_you_mean(key, known) for key in unknown}
        missing = [key for key in _required(error) if key not in node and f"did you mean '{key}'?" not in misspelt]
        span = _owner_span(root, path)
        for key in missing:
            hint = _key_hint(key, schema)
            about = ".".join(map(str, (*path, key)))
            message = f"'{key}' is missing{_where(path)}"
            diagnostics.error("missing-key", span, message, hint=hint, notes=notes, about=about)
        return
    id, message, hint = _explain(keyword, error, schema)
    diagnostics.error(id, node.span, message, hint=hint, notes=notes)


BOUND_WORDS = {
    "minimum": "at least",
    "exclusiveMinimum": "more than",
    "maximum": "at most",
    "exclusiveMaximum": "less than",
}


def _explain(keyword: str, error: Any, schema: Mapping[str, Any]) -> tuple[str, str, str]:
    """Id, message and hint for a wrong value; missing and unknown keys are reported elsewhere."""
    value, limit = error.instance, error.validator_value
    if "x-quantity" in schema and keyword in ("type", "pattern", "anyOf", "oneOf"):
        problem = _quantity_problem(value, schema["x-quantity"])
        if problem is not None:
            return problem.id, str(problem), problem.hint
        if keyword == "pattern":
            return "out-of-range", f"{_shown(value)} must not have a sign", "write the number without a sign"
    if "x-message" in schema and keyword in ("pattern", "anyOf", "oneOf", "not"):
        return "wrong-value", f"{_shown(value)} {schema['x-message']}", str(schema.get("x-hint", ""))
    if keyword == "pattern":
        return "wrong-value", f"{_shown(value)} does not have the required form", _form(schema)
    if keyword == "type":
        wanted = [limit] if isinstance(limit, str) else list(limit)
        names = " or ".join(_TYPE_NAMES.get(name, name) for name in wanted)
        return "wrong-type", f"expected {names}, found {_shown(value)}", _type_hint(value, wanted)
    if keyword in ("anyOf", "oneOf"):
        kinds = [_TYPE_NAMES.get(str(option.get("type")), "") for option in limit if isinstance(option, dict)]
        expected = " or ".join(dict.fromkeys(kind for kind in kinds if kind)) or "something else"
        return "wrong-type", f"expected {expected}, found {_shown(value)}", ""
    return _explain_limit(keyword, value, limit)


def _quantity_problem(value: object, dimension: str) -> QuantityError | None:
    try:
        if dimension == "ratio":
            parse_ratio(value)
        else:
            parse_quantity(value, dimension)
    except QuantityError as problem:
        return problem
    return None


def _explain_limit(keyword: str, value: object, limit: Any) -> tuple[str, str, str]:
    """Id, message and hint for a value of the right type that is out of range or not among the possible values."""
    if keyword == "enum":
        return "wrong-value", f"{_shown(value)} is not possible here", did_you_mean(str(value), map(str, limit))
    if keyword == "const":
        return "wrong-value", f"expected {_shown(limit)}, found {_shown(value)}", ""
    if keyword in BOUND_WORDS:
        return "out-of-range", f"{_shown(value)} is out of range: must be {BOUND_WORDS[keyword]} {limit}", ""
    if keyword == "uniqueItems":
        return "wrong-value", "this list has the same value twice", "remove one of the two"
    if keyword in ("minItems", "maxItems") and isinstance(value, list) and value:
        bound = "at least" if keyword == "minItems" else "at most"
        comma = keyword == "maxItems" and all(isinstance(item, (int, float)) for item in value)
        hint = "write 1.5 instead of 1,5: a comma begins the next number" if comma else ""
        return "wrong-value", f"expected {bound} {limit} values, found {len(value)}", hint
    if keyword in ("minProperties", "minItems", "minLength"):
        return "wrong-value", "this must not be empty", ""
    return "wrong-value", f"{_shown(value)} is not possible here ({keyword} {limit})", ""


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


def _type_hint(value: object, wanted: list[str]) -> str:
    if "boolean" in wanted and isinstance(value, str) and value.casefold() in ("on", "off", "yes", "no", "y", "n"):
        return (
            f"write {'true' if value.casefold() in ('on', 'yes', 'y') else 'false'}: YAML 1.2 has only true and false"
        )
    if isinstance(value, str) and {"number", "integer"} & set(wanted):
        return number_hint(value)
    if isinstance(value, str) and "object" in wanted:
        key = re.match(r"([A-Za-z_]\w*)\s*[=\s:]", value)
        return f"write ':' after each key, for example '{key[1]}: ...'" if key else ""
    if isinstance(value, list) and "object" in wanted:
        return "write 'name: value' for each entry, without '-' and without [ ]"
    if "string" in wanted and isinstance(value, (int, float, bool)):
        return "put it in quotes if it is meant as text"
    return ""


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


def _where(path: Path) -> str:
    return f" in '{'.'.join(map(str, path))}'" if path else ""


def _owner_span(root: YamlNode, path: Path) -> Span:
    """The position of the key whose value is the map at ``path``."""
    if not path:
        return root.span
    above = root.get(*path[:-1])
    if above is not None and isinstance(path[-1], str):
        return above.key_span(path[-1])
    node = root.get(*path)
    return node.span if node else root.span
