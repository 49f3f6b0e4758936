# SPDX-License-Identifier: Apache-2.0
"""Merges ``.tcf`` files that extend each other, in the way of devicetree overlays.

:mod:`epg.generator.documents.merge` has the rules.  Every value keeps its position in its own file, and gets the
positions of each ``extends`` that leads there (:attr:`epg.generator.source.YamlNode.origins`).
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace
from types import MappingProxyType

from epg.generator.documents.merge import merge, without_nulls
from epg.generator.documents.tcf import TcfFile
from epg.generator.source import Span, YamlNode


def merge_chain(chain: Sequence[TcfFile]) -> YamlNode:
    """The merged tree of a chain (the extending file first), without ``extends`` and without ``null``."""
    merged: YamlNode | None = None
    origins: list[Span] = [file.extended_by for file in chain[1:] if file.extended_by is not None]
    composed = {str(file.path) for file in chain if file.is_composed}  # users cannot look into these
    for index in range(len(chain) - 1, -1, -1):
        node = _with_origins(
            chain[index].node, tuple(span for span in reversed(origins[:index]) if span.file not in composed)
        )
        node = _without(node, "extends")
        merged = node if merged is None else merge(merged, node)
    assert merged is not None
    return without_nulls(merged)


def apply_settings(root: YamlNode, settings: Iterable[tuple[tuple[str, ...], YamlNode]]) -> YamlNode:
    """``root`` with the values of settings (keys, value).  Maps that do not exist are created."""
    for path, node in settings:
        for key in reversed(path):
            node = YamlNode(MappingProxyType({key: node}), node.span, MappingProxyType({key: node.span}))
        root = replace(merge(root, node), span=root.span)
    return without_nulls(root)


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
