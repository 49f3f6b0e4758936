# SPDX-License-Identifier: Apache-2.0
"""The check without jsonschema accepts exactly the documents that jsonschema accepts."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from jsonschema import Draft202012Validator

from epg.generator.data import data_folder
from epg.generator.diagnostics import Diagnostics
from epg.generator.documents.accept import accepts
from epg.generator.documents.schema import load_schema
from epg.generator.documents.yaml_file import load_yaml

SCALARS = st.one_of(
    st.none(),
    st.booleans(),
    st.integers(-3, 3),
    st.sampled_from([0.0, 1.0, -2.5, 1e300]),
    st.sampled_from(["", "a", "ab", "1 ms", "a b"]),
)
KEYS = st.sampled_from(["a", "b", "1x"])
VALUES = st.recursive(SCALARS, lambda inner: st.lists(inner, max_size=3) | st.dictionaries(KEYS, inner, max_size=3))
TYPES = st.sampled_from(["object", "array", "string", "number", "integer", "boolean", "null"])
SMALL = st.integers(0, 3)
SIMPLE = {
    "type": TYPES | st.lists(TYPES, min_size=1, max_size=3, unique=True),
    "enum": st.lists(SCALARS, min_size=1, max_size=3),
    "const": SCALARS,
    "pattern": st.sampled_from(["^a", "b$", "^[a-z]+$", "."]),
    "minimum": st.integers(-2, 2),
    "maximum": st.sampled_from([-1, 0.5, 2]),
    "exclusiveMinimum": st.integers(-2, 2),
    "exclusiveMaximum": st.integers(-2, 2),
    "minLength": SMALL,
    "maxLength": SMALL,
    "minItems": SMALL,
    "maxItems": SMALL,
    "minProperties": SMALL,
    "maxProperties": SMALL,
    "uniqueItems": st.booleans(),
    "required": st.lists(KEYS, max_size=2, unique=True),
    "$ref": st.sampled_from(["#/$defs/one", "#/$defs/two"]),
    "description": st.just("text"),
    "x-quantity": st.just("time"),
}


def schemas(inner: st.SearchStrategy[Any]) -> st.SearchStrategy[dict[str, Any]]:
    return st.fixed_dictionaries(
        {},
        optional={
            "properties": st.dictionaries(KEYS, inner, max_size=2),
            "additionalProperties": inner | st.booleans(),
            "propertyNames": inner,
            "items": inner,
            "anyOf": st.lists(inner, min_size=1, max_size=3),
            "oneOf": st.lists(inner, min_size=1, max_size=3),
            "type": TYPES,
            "minimum": SMALL,
        },
    )


LEAVES = st.fixed_dictionaries({}, optional={key: value for key, value in SIMPLE.items() if key != "$ref"})
SCHEMAS = st.recursive(st.fixed_dictionaries({}, optional=SIMPLE), schemas, max_leaves=6)


@settings(max_examples=300, deadline=None)
@given(SCHEMAS, LEAVES, LEAVES, VALUES)
def test_the_same_verdict_as_jsonschema(schema: dict[str, Any], one: Any, two: Any, value: Any) -> None:
    whole = {**schema, "$defs": {"one": one, "two": two}}
    fits = Draft202012Validator(whole).is_valid(value)
    verdict = accepts(value, whole)
    assert fits or not verdict, "accepted what does not fit"
    text = json.dumps(whole)
    sure = '"uniqueItems": true' not in text
    assert verdict == fits or not sure, "asks jsonschema where it need not"


@settings(max_examples=300, deadline=None)
@given(SCHEMAS, LEAVES, LEAVES, VALUES)
def test_partial_is_what_is_left_without_missing_keys_and_nulls(schema: Any, one: Any, two: Any, value: Any) -> None:
    whole = {**schema, "$defs": {"one": one, "two": two}}
    errors = [
        error
        for error in Draft202012Validator(whole).iter_errors(value)
        if error.validator != "required" and error.instance is not None
    ]
    assert not (accepts(value, whole, partial=True) and errors)


@pytest.mark.parametrize("keyword", ["patternProperties", "not", "$dynamicRef", "misspelt"])
def test_what_is_not_known_is_not_accepted(keyword: str) -> None:
    assert not accepts({}, {keyword: {}})
    assert not accepts("a", {"$ref": "other.json"})


def test_epgs_own_files_are_accepted_without_jsonschema() -> None:
    targets = data_folder("targets")
    categories = {"soc": "socs", "board": "boards", "platform": "platforms", "family": "families"}
    categories |= {"component": "components"}
    for category, folder in categories.items():
        found = sorted((targets / folder).glob(f"*/{category}.yaml"))
        assert found
        for path in found:
            node = load_yaml(path, Diagnostics())
            assert node is not None
            assert "extends" in node or accepts(node.plain(), load_schema(category)), path
    for path in sorted(Path(targets / "robots").glob("*/*.tcf")):
        node = load_yaml(path, Diagnostics())
        assert node is not None and accepts(node.plain(), load_schema("tcf"), partial=True), path
