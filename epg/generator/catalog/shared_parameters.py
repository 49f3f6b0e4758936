# SPDX-License-Identifier: Apache-2.0
"""Parameters that several kinds share: ``components/common/<name>.yaml`` in the folders of targets."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from types import MappingProxyType

from epg.generator.diagnostics import Diagnostics
from epg.generator.documents.schema import validate
from epg.generator.documents.yaml_file import load_yaml, newer_version
from epg.generator.source import YamlNode

KEY = "parameters_from"
_SCHEMA = {
    "type": "object",
    "required": ["api", "parameters"],
    "additionalProperties": False,
    "properties": {"api": {"const": 1, "examples": [1]}, "parameters": {"type": "object"}},
}


def with_shared_parameters(kind: YamlNode, roots: Sequence[Path], diagnostics: Diagnostics) -> YamlNode | None:
    """The kind's ``component.yaml`` with the parameters of the files that it names; None after reporting mistakes.

    A parameter of the kind itself replaces a shared one of the same name, and a later file replaces an earlier one.
    The position of each parameter stays in the file in which it is written.
    """
    names = kind.get(KEY)
    own = kind.get("parameters") or YamlNode(MappingProxyType({}), kind.span)
    if names is None or not names.is_sequence or not own.is_mapping:
        return kind  # There are no shared parameters, or the check against the schema reports the mistake.
    values, keys = dict(own.items()), dict(own.keys)
    for name in names.elements():
        shared = _load(name, roots, diagnostics)
        if shared is None:
            return None
        for parameter, value in shared.items():
            if parameter not in own:
                values[parameter], keys[parameter] = value, shared.key_span(parameter)
    merged = replace(own, value=MappingProxyType(values), keys=MappingProxyType(keys))
    return replace(kind, value=MappingProxyType({**dict(kind.items()), "parameters": merged}))


def _load(name: YamlNode, roots: Sequence[Path], diagnostics: Diagnostics) -> YamlNode | None:
    """The parameters in the file ``name`` of the first folder of targets that has it; None after reporting mistakes."""
    files = {path.stem: path for root in reversed(roots) for path in (root / "components" / "common").glob("*.yaml")}
    message, words = f"there are no shared parameters '{name.value}'", "files in components/common/"
    if not diagnostics.known_or_error("unknown-name", name.span, message, str(name.value), files, words):
        return None
    node = load_yaml(files[str(name.value)], diagnostics)
    if node is None or newer_version(node, "api", diagnostics) or not validate(node, _SCHEMA, diagnostics):
        return None
    return node["parameters"]
