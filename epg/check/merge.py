# SPDX-License-Identifier: Apache-2.0
"""Merges ``.tcf`` files that extend each other, in the way of devicetree overlays.

Maps are merged key by key.  Lists and scalars replace those of the extended file.  ``null`` deletes a key.  Every value
keeps its position in its own file, and gets the positions of each ``extends`` that leads there
(:attr:`epg.source.YamlNode.origins`).
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace
from types import MappingProxyType

from epg.documents.tcf import TcfFile
from epg.source import Span, YamlNode


def merge_chain(chain: Sequence[TcfFile]) -> YamlNode:
    """The merged tree of a chain (the extending file first), without ``extends`` and without ``null``."""
    merged: YamlNode | None = None
    origins: list[Span] = [file.extended_by for file in chain if file.extended_by is not None]
    for index in range(len(chain) - 1, -1, -1):
        node = _with_origins(chain[index].node, tuple(reversed(origins[:index])))
        node = _without(node, "extends")
        merged = node if merged is None else merge(merged, node)
    assert merged is not None
    return without_nulls(merged)


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


def apply_settings(root: YamlNode, settings: Iterable[tuple[tuple[str, ...], YamlNode]]) -> YamlNode:
    """``root`` with the values of settings (keys, value).  Maps that do not exist are created."""
    for path, node in settings:
        for key in reversed(path):
            node = YamlNode(MappingProxyType({key: node}), node.span, MappingProxyType({key: node.span}))
        root = replace(merge(root, node), span=root.span)
    return without_nulls(root)


def without_nulls(node: YamlNode) -> YamlNode:
    """The tree without the keys whose value is ``null``."""
    if not node.is_mapping:
        return node
    values = {key: without_nulls(child) for key, child in node.items() if child.value is not None}
    keys = {key: node.key_span(key) for key in values}
    return replace(node, value=MappingProxyType(values), keys=MappingProxyType(keys))


def _without(node: YamlNode, key: str) -> YamlNode:
    values = {k: child for k, child in node.items() if k != key}
    return replace(node, value=MappingProxyType(values))


def _with_origins(node: YamlNode, origins: tuple[Span, ...]) -> YamlNode:
    if not origins:
        return node
    if node.is_mapping:
        values = {key: _with_origins(child, origins) for key, child in node.items()}
        return replace(node, value=MappingProxyType(values), origins=origins)
    if node.is_sequence:
        return replace(node, value=tuple(_with_origins(child, origins) for child in node.elements()), origins=origins)
    return replace(node, origins=origins)
