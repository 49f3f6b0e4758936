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
_OF_ONE_TYPE = ("pattern", "uniqueItems", "items", "properties", "additionalProperties", "propertyNames", "required")


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

    # One function, because it is a list of cases: one for each keyword.
    def _fits_keyword(self, value: Any, keyword: str, wanted: Any, schema: Schema) -> bool:
        """True if ``value`` fits one keyword."""
        if keyword in _OF_ONE_TYPE:
            return self._fits_keyword_of_one_type(value, keyword, wanted, schema)
        if keyword in _BOUNDS:
            return not _is_type(value, "number") or _BOUNDS[keyword](value, wanted)
        if keyword in _LENGTHS:
            kind, compare = _LENGTHS[keyword]
            return not isinstance(value, kind) or compare(len(value), wanted)
        match keyword:
            case "type":
                names = [wanted] if isinstance(wanted, str) else wanted
                return any(_is_type(value, name) for name in names)
            case "enum":
                return any(_same(value, option) for option in wanted)
            case "const":
                return _same(value, wanted)
            case "anyOf":
                return any(self._whole.fits(value, option) for option in wanted)
            case "oneOf":
                return sum(self._whole.fits(value, option) for option in wanted) == 1
            case "if":
                return self.fits(value, schema.get("then" if self._whole.fits(value, wanted) else "else", True))
            case "$ref":
                name = str(wanted).removeprefix("#/$defs/")
                if "/" in name or name not in self._definitions:
                    raise _Unknown(wanted)
                return self.fits(value, self._definitions[name])
            case "dependentRequired" if self._partial:
                return True
        raise _Unknown(keyword)

    def _fits_keyword_of_one_type(self, value: Any, keyword: str, wanted: Any, schema: Schema) -> bool:
        """True if ``value`` fits one keyword, which means nothing for values of other types."""
        match keyword, value:
            case "pattern", str():
                return re.search(wanted, value) is not None
            case "uniqueItems", list():
                if wanted and not all(isinstance(item, str) for item in value):
                    raise _Unknown("uniqueItems of other things than texts")
                return not wanted or len(set(value)) == len(value)
            case "items", list():
                return all(self.fits(item, wanted) for item in value)
            case "properties", dict():
                return all(self.fits(value[key], sub) for key, sub in wanted.items() if key in value)
            case "additionalProperties", dict():
                known = schema.get("properties", {})
                return all(self.fits(child, wanted) for key, child in value.items() if key not in known)
            case "propertyNames", dict():
                return all(self.fits(key, wanted) for key in value)
            case "required", dict():
                return self._partial or all(key in value for key in wanted)
        return True
