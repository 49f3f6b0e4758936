# SPDX-License-Identifier: Apache-2.0
"""A fast check that a value fits a schema, which does not import jsonschema.

jsonschema explains why a value does not fit, but its import takes longer than all checks of EPG together, and most
values fit.  :func:`accepts` implements the keywords of EPG's own schemas, with their meaning in JSON Schema draft
2020-12.  It returns False for every keyword that it does not know.  The caller asks jsonschema only after False.
"""

from __future__ import annotations

import operator
import re
from collections.abc import Callable, Mapping
from typing import Any

Schema = Mapping[str, Any]

# "then" and "else" are part of "if".
_ANNOTATIONS = frozenset(
    ("$schema", "$id", "$defs", "$comment", "title", "description", "default", "examples", "deprecated", "then", "else")
)
_TYPES: Mapping[str, type] = {"object": dict, "array": list, "string": str, "boolean": bool, "null": type(None)}
_BOUNDS: Mapping[str, Callable[[Any, Any], bool]] = {
    "minimum": operator.ge,
    "maximum": operator.le,
    "exclusiveMinimum": operator.gt,
    "exclusiveMaximum": operator.lt,
}
_LENGTHS: Mapping[str, tuple[type[Any], Callable[[int, Any], bool]]] = {
    "minLength": (str, operator.ge),
    "maxLength": (str, operator.le),
    "minItems": (list, operator.ge),
    "maxItems": (list, operator.le),
    "minProperties": (dict, operator.ge),
    "maxProperties": (dict, operator.le),
}


class _Unknown(Exception):
    """A schema uses a keyword, or a form of one, that this module does not implement."""


def accepts(value: object, schema: Schema, *, partial: bool = False) -> bool:
    """True if ``value`` certainly fits ``schema``.

    With ``partial``, keys may be missing, and every value may be None.
    """
    try:
        return _Check(schema, partial).fits(value, schema)
    except _Unknown:
        return False


def _is_type(value: Any, name: str) -> bool:
    if name == "integer":
        return _is_type(value, "number") and value % 1 == 0
    if name == "number":
        return not isinstance(value, bool) and isinstance(value, (int, float))
    if name not in _TYPES:
        raise _Unknown(name)
    return isinstance(value, _TYPES[name])


def _same(one: object, other: object) -> bool:
    """Compares two scalars as JSON does: ``True`` is not equal to 1."""
    structures = isinstance(one, (dict, list)), isinstance(other, (dict, list))
    if all(structures):
        raise _Unknown("equality of structures")
    return not any(structures) and isinstance(one, bool) == isinstance(other, bool) and one == other


class _Check:
    """A check with the definitions of the schema ``root``.  All its methods raise :class:`_Unknown`."""

    def __init__(self, root: Schema, partial: bool) -> None:
        self._definitions = root.get("$defs", {})
        self._partial = partial
        self._whole = _Check(root, partial=False) if partial else self

    def fits(self, value: object, schema: Any) -> bool:
        """True if ``value`` fits ``schema``, which is a part of the root."""
        if isinstance(schema, bool):
            return schema
        if self._partial and value is None:
            return True
        for keyword, wanted in schema.items():
            if keyword in _ANNOTATIONS or keyword.startswith("x-"):
                continue
            if not self._fits_keyword(value, keyword, wanted, schema):
                return False
        return True

    def _fits_keyword(self, value: Any, keyword: str, wanted: Any, schema: Schema) -> bool:
        """True if ``value`` fits one keyword."""
        if keyword in _KEYWORDS:
            kind, check = _KEYWORDS[keyword]
            return not isinstance(value, kind) or check(self, value, wanted, schema)
        if keyword in _BOUNDS:
            return not _is_type(value, "number") or _BOUNDS[keyword](value, wanted)
        if keyword in _LENGTHS:
            kind, compare = _LENGTHS[keyword]
            return not isinstance(value, kind) or compare(len(value), wanted)
        raise _Unknown(keyword)

    def _type(self, value: Any, wanted: Any, schema: Schema) -> bool:
        names = [wanted] if isinstance(wanted, str) else wanted
        return any(_is_type(value, name) for name in names)

    def _enum(self, value: Any, wanted: Any, schema: Schema) -> bool:
        return any(_same(value, option) for option in wanted)

    def _const(self, value: Any, wanted: Any, schema: Schema) -> bool:
        return _same(value, wanted)

    def _any_of(self, value: Any, wanted: Any, schema: Schema) -> bool:
        return any(self._whole.fits(value, option) for option in wanted)

    def _one_of(self, value: Any, wanted: Any, schema: Schema) -> bool:
        return sum(self._whole.fits(value, option) for option in wanted) == 1

    def _if(self, value: Any, wanted: Any, schema: Schema) -> bool:
        return self.fits(value, schema.get("then" if self._whole.fits(value, wanted) else "else", True))

    def _reference(self, value: Any, wanted: Any, schema: Schema) -> bool:
        name = str(wanted).removeprefix("#/$defs/")
        if "/" in name or name not in self._definitions:
            raise _Unknown(wanted)
        return self.fits(value, self._definitions[name])

    def _dependent_required(self, value: Any, wanted: Any, schema: Schema) -> bool:
        if not self._partial:
            raise _Unknown("dependentRequired")
        return True

    def _pattern(self, value: str, wanted: Any, schema: Schema) -> bool:
        return re.search(wanted, value) is not None

    def _unique_items(self, value: list[Any], wanted: Any, schema: Schema) -> bool:
        if wanted and not all(isinstance(item, str) for item in value):
            raise _Unknown("uniqueItems of other things than texts")
        return not wanted or len(set(value)) == len(value)

    def _items(self, value: list[Any], wanted: Any, schema: Schema) -> bool:
        return all(self.fits(item, wanted) for item in value)

    def _properties(self, value: dict[str, Any], wanted: Any, schema: Schema) -> bool:
        return all(self.fits(value[key], sub) for key, sub in wanted.items() if key in value)

    def _additional_properties(self, value: dict[str, Any], wanted: Any, schema: Schema) -> bool:
        known = schema.get("properties", {})
        return all(self.fits(child, wanted) for key, child in value.items() if key not in known)

    def _property_names(self, value: dict[str, Any], wanted: Any, schema: Schema) -> bool:
        return all(self.fits(key, wanted) for key in value)

    def _required(self, value: dict[str, Any], wanted: Any, schema: Schema) -> bool:
        return self._partial or all(key in value for key in wanted)


_KEYWORDS: Mapping[str, tuple[type, Callable[[_Check, Any, Any, Schema], bool]]] = {
    "type": (object, _Check._type),
    "enum": (object, _Check._enum),
    "const": (object, _Check._const),
    "anyOf": (object, _Check._any_of),
    "oneOf": (object, _Check._one_of),
    "if": (object, _Check._if),
    "$ref": (object, _Check._reference),
    "dependentRequired": (object, _Check._dependent_required),
    "pattern": (str, _Check._pattern),
    "uniqueItems": (list, _Check._unique_items),
    "items": (list, _Check._items),
    "properties": (dict, _Check._properties),
    "additionalProperties": (dict, _Check._additional_properties),
    "propertyNames": (dict, _Check._property_names),
    "required": (dict, _Check._required),
}
"""For each keyword, the type of the values to which it applies, and its check."""
