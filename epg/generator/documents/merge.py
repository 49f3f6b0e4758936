# SPDX-License-Identifier: Apache-2.0
"""Merges YAML documents that extend each other.

Maps are merged key by key.  Lists and scalars replace those of the extended file.  ``null`` deletes a key.  Every value
keeps its position in its own file.

Lists are not joined: a file could then add an element, but never leave one out or change their order.  ``null`` does
for keys what a shorter list does for elements.
"""

from __future__ import annotations

from dataclasses import replace
from types import MappingProxyType

from epg.generator.source import YamlNode


def merge(base: YamlNode, overlay: YamlNode) -> YamlNode:
    """``base`` with the values of ``overlay``.  Values ``null`` stay: see :func:`without_nulls`."""
    if not (base.is_mapping and overlay.is_mapping):
        return overlay
    values = dict(base.items())
    keys = dict(base.keys)
    for key, node in overlay.items():
        values[key] = merge(values[key], node) if key in values else node
        keys[key] = overlay.key_span(key)
    return replace(base, value=MappingProxyType(values), keys=MappingProxyType(keys), span=overlay.span)


def without_nulls(node: YamlNode) -> YamlNode:
    """The tree without the keys whose value is ``null``."""
    if not node.is_mapping:
        return node
    values = {key: without_nulls(child) for key, child in node.items() if child.value is not None}
    keys = {key: node.key_span(key) for key in values}
    return replace(node, value=MappingProxyType(values), keys=MappingProxyType(keys))
