# SPDX-License-Identifier: Apache-2.0
"""The schemas of EPG's files and the parameters of kinds explain their patterns in words."""

from __future__ import annotations

import json
from typing import Any

from epg.generator.data import data_folder
from epg.generator.diagnostics import Diagnostics
from epg.generator.documents.yaml_file import load_yaml


def _patterns(schema: Any, place: str) -> list[tuple[str, dict[str, Any]]]:
    """The schemas with a pattern in ``schema``, and the position of each."""
    if isinstance(schema, list):
        return [found for number, child in enumerate(schema) for found in _patterns(child, f"{place}/{number}")]
    if not isinstance(schema, dict):
        return []
    own = [(place, schema)] if isinstance(schema.get("pattern"), str) else []
    return own + [found for key, child in schema.items() for found in _patterns(child, f"{place}/{key}")]


def test_every_pattern_is_explained_in_words() -> None:
    """A regular expression does not help a user: it must have a sentence beside it, or the dimension of a quantity."""
    schemas = {path.name: json.loads(path.read_text()) for path in data_folder("schemas").glob("*.schema.json")}
    found = [each for name, schema in schemas.items() for each in _patterns(schema, name)]
    assert len(found) > 30
    assert [place for place, schema in found if not {"x-message", "x-quantity"} & schema.keys()] == []


def test_every_pattern_of_a_kind_is_explained_in_words() -> None:
    """The message about a parameter that does not match uses the kind's text for it."""
    folders = [
        *data_folder("targets").glob("components/*/*.yaml"),
        *data_folder("targets").glob("middlewares/*/*.yaml"),
    ]
    found = []
    for path in folders:
        node = load_yaml(path, Diagnostics())
        assert node is not None
        found += _patterns(node.plain(), path.parent.name)
    assert found
    assert [place for place, parameter in found if not parameter.get("description")] == []
