# SPDX-License-Identifier: Apache-2.0
"""A fast check that a value fits a schema, which does not import jsonschema.

jsonschema explains why a value does not fit, but its import takes longer than all checks of EPG together, and most
values fit.  :func:`accepts` implements the keywords of EPG's own schemas, with their meaning in JSON Schema draft
2020-12.  It returns False for every keyword that it does not know.  The caller asks jsonschema only after False.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from typing import Any

Schema = Mapping[str, Any]

# "then" and "else" are part of "if".
_ANNOTATIONS = frozenset(
    ("$schema", "$id", "$defs", "$comment", "title", "description", "default", "examples", "deprecated", "then", "else")
)


class _Unknown(Exception):
    """A schema uses a keyword, or a form of one, that this module does not implement."""


def accepts(value: object, schema: Schema, *, partial: bool = False) -> bool:
    """True if ``value`` certainly fits ``schema``.

    With ``partial``, keys may be missing, and every value may be None.
    """
    try:
        return _fits(value, schema, schema, partial)
    except _Unknown:
        return False


def _fits(value: object, schema: Any, root: Schema, partial: bool) -> bool:
    """True if ``value`` fits ``schema``, a part of the schema ``root``.  Raises :class:`_Unknown`."""
    if isinstance(schema, bool):
        return schema
    if partial and value is None:
        return True
    for keyword, wanted in schema.items():
        if keyword in _ANNOTATIONS or keyword.startswith("x-"):
            continue
        if partial and keyword in ("required", "dependentRequired"):
            continue
        check = _KEYWORDS.get(keyword)
        if check is None:
            raise _Unknown(keyword)
        if not check(value, wanted, schema, root, partial):
            return False
    return True


def _is_type(value: object, name: str) -> bool:
    if name == "integer":
        return not isinstance(value, bool) and (
            isinstance(value, int) or (isinstance(value, float) and value.is_integer())
        )
    if name == "number":
        return not isinstance(value, bool) and isinstance(value, (int, float))
    if name not in _TYPES:
        raise _Unknown(name)
    return isinstance(value, _TYPES[name])


_TYPES: Mapping[str, type] = {"object": dict, "array": list, "string": str, "boolean": bool, "null": type(None)}


def _type(value: object, wanted: Any, schema: Schema, root: Schema, partial: bool) -> bool:
    names = [wanted] if isinstance(wanted, str) else wanted
    return any(_is_type(value, name) for name in names)


def _same(one: object, other: object) -> bool:
    """Compares two scalars as JSON does: ``True`` is not equal to 1."""
    structures = isinstance(one, (dict, list)), isinstance(other, (dict, list))
    if all(structures):
        raise _Unknown("equality of structures")
    return not any(structures) and isinstance(one, bool) == isinstance(other, bool) and one == other


def _enum(value: object, wanted: Any, schema: Schema, root: Schema, partial: bool) -> bool:
    return any(_same(value, option) for option in wanted)


def _const(value: object, wanted: Any, schema: Schema, root: Schema, partial: bool) -> bool:
    return _same(value, wanted)


def _pattern(value: object, wanted: Any, schema: Schema, root: Schema, partial: bool) -> bool:
    return not isinstance(value, str) or re.search(wanted, value) is not None


def _bound(compare: Callable[[Any, Any], bool]) -> Callable[..., bool]:
    def check(value: object, wanted: Any, schema: Schema, root: Schema, partial: bool) -> bool:
        return not _is_type(value, "number") or compare(value, wanted)

    return check


def _length(kind: type[Any], compare: Callable[[int, Any], bool]) -> Callable[..., bool]:
    def check(value: Any, wanted: Any, schema: Schema, root: Schema, partial: bool) -> bool:
        return not isinstance(value, kind) or compare(len(value), wanted)

    return check


def _unique(value: object, wanted: Any, schema: Schema, root: Schema, partial: bool) -> bool:
    if not wanted or not isinstance(value, list):
        return True
    if not all(isinstance(item, str) for item in value):
        raise _Unknown("uniqueItems of other things than texts")
    return len(set(value)) == len(value)


def _properties(value: object, wanted: Any, schema: Schema, root: Schema, partial: bool) -> bool:
    if not isinstance(value, dict):
        return True
    return all(_fits(value[key], sub, root, partial) for key, sub in wanted.items() if key in value)


def _additional(value: object, wanted: Any, schema: Schema, root: Schema, partial: bool) -> bool:
    if not isinstance(value, dict):
        return True
    known = schema.get("properties", {})
    return all(_fits(child, wanted, root, partial) for key, child in value.items() if key not in known)


def _names(value: object, wanted: Any, schema: Schema, root: Schema, partial: bool) -> bool:
    return not isinstance(value, dict) or all(_fits(key, wanted, root, partial) for key in value)


def _required(value: object, wanted: Any, schema: Schema, root: Schema, partial: bool) -> bool:
    return not isinstance(value, dict) or all(key in value for key in wanted)


def _items(value: object, wanted: Any, schema: Schema, root: Schema, partial: bool) -> bool:
    return not isinstance(value, list) or all(_fits(item, wanted, root, partial) for item in value)


def _any_of(value: object, wanted: Any, schema: Schema, root: Schema, partial: bool) -> bool:
    return any(_fits(value, option, root, False) for option in wanted)


def _one_of(value: object, wanted: Any, schema: Schema, root: Schema, partial: bool) -> bool:
    return sum(_fits(value, option, root, False) for option in wanted) == 1


def _if(value: object, wanted: Any, schema: Schema, root: Schema, partial: bool) -> bool:
    branch = "then" if _fits(value, wanted, root, False) else "else"
    return _fits(value, schema.get(branch, True), root, partial)


def _reference(value: object, wanted: Any, schema: Schema, root: Schema, partial: bool) -> bool:
    name = str(wanted).removeprefix("#/$defs/")
    if "/" in name or name not in root.get("$defs", {}):
        raise _Unknown(wanted)
    return _fits(value, root["$defs"][name], root, partial)


_KEYWORDS: Mapping[str, Callable[..., bool]] = {
    "type": _type,
    "enum": _enum,
    "const": _const,
    "pattern": _pattern,
    "minimum": _bound(lambda value, limit: value >= limit),
    "maximum": _bound(lambda value, limit: value <= limit),
    "exclusiveMinimum": _bound(lambda value, limit: value > limit),
    "exclusiveMaximum": _bound(lambda value, limit: value < limit),
    "minLength": _length(str, lambda length, limit: length >= limit),
    "maxLength": _length(str, lambda length, limit: length <= limit),
    "minItems": _length(list, lambda length, limit: length >= limit),
    "maxItems": _length(list, lambda length, limit: length <= limit),
    "minProperties": _length(dict, lambda length, limit: length >= limit),
    "maxProperties": _length(dict, lambda length, limit: length <= limit),
    "uniqueItems": _unique,
    "properties": _properties,
    "additionalProperties": _additional,
    "propertyNames": _names,
    "required": _required,
    "items": _items,
    "anyOf": _any_of,
    "oneOf": _one_of,
    "if": _if,
    "$ref": _reference,
}
