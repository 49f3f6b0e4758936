# SPDX-License-Identifier: Apache-2.0
"""The ends of wires in a bindings file, in two forms: texts to show and edit, and data to compare."""

from __future__ import annotations

from typing import Any

from epg.edit.scalars import scalar_text
from epg.generator.check.bindings import UNCONNECTED
from epg.generator.dataclass import dataclass
from epg.generator.diagnostics import Diagnostics
from epg.generator.documents.yaml_file import parse_yaml
from epg.generator.source import YamlNode

REFERENCE = {"inputs": "from", "outputs": "to"}
"""Section -> the key in the map of a binding that names the component."""
KEYS = ("scale", "offset", "limits", "unit", "follows")
"""The other keys of a binding, in the order in which they are added to a map."""


@dataclass(frozen=True)
class WireEnd:
    """One end of a wire as it is written: as texts, so that 1/4 stays 1/4.  Texts that are not stated are empty."""

    reference: str  # "encoder_pan" or "encoder_pan.reset"
    scale: str = ""
    offset: str = ""
    limits: tuple[str, str] | None = None
    unit: str = ""
    follows: str = ""


def ends_of(root: YamlNode, section: str, port: str) -> tuple[WireEnd, ...] | None:
    """The ends of a port in a file: None if the file does not name the port, an empty tuple for ``unconnected``.

    ``section`` is "inputs" or "outputs".  A value that the schema does not allow gives as many ends as can be read.
    """
    node = root.get(section, port)
    if node is None:
        return None
    ends = node.elements() if node.is_sequence else (node,)
    return tuple(_end(end, REFERENCE[section]) for end in ends if section == "inputs" or end.value != UNCONNECTED)


def references_of(root: YamlNode | None) -> dict[str, tuple[str, ...]]:
    """The component ports to which the ports of a model are bound; empty without a map."""
    result: dict[str, tuple[str, ...]] = {}
    for section in REFERENCE if root is not None and root.is_mapping else ():
        node = root.get(section) if root is not None else None
        for port, _ in node.items() if node is not None and node.is_mapping else ():
            assert root is not None
            ends = ends_of(root, section, port) or ()
            result[port] = (*result.get(port, ()), *(end.reference for end in ends))
    return result


def said_ends(node: YamlNode | None, section: str) -> list[Any] | None:
    """The value of a port as data: for each end a sorted list of keys and values, the same for all ways to write it."""
    if node is None:
        return None
    ends = node.elements() if node.is_sequence else (node,)
    maps = [
        {key: child.plain() for key, child in end.items()} if end.is_mapping else {REFERENCE[section]: end.plain()}
        for end in ends
        if section == "inputs" or end.value != UNCONNECTED
    ]
    # An empty unit means the same as no unit.
    return [sorted((key, value) for key, value in said.items() if (key, value) != ("unit", "")) for said in maps]


def data_of(end: WireEnd, section: str) -> list[tuple[str, object]]:
    """The data that :func:`said_ends` returns for a file with this ``end``."""
    said: list[tuple[str, object]] = [(REFERENCE[section], end.reference)]
    for key in KEYS:
        value = getattr(end, key)
        if key == "limits" and value is not None:
            said.append((key, [typed_value(key, number) for number in value]))
        elif value:
            said.append((key, typed_value(key, value)))
    return sorted(said)


def typed_value(key: str, text: str) -> object:
    """The number that YAML reads from ``text``; ``text`` itself if it is not a number or if ``key`` takes text."""
    if (
        key in ("reference", "unit", "follows")
        or not text
        or any(not (c.isascii() and (c.isalnum() or c in "+-.")) for c in text)
    ):
        return text
    node = parse_yaml(text, "", Diagnostics())
    value = None if node is None else node.value
    return value if isinstance(value, (int, float)) and not isinstance(value, bool) else text


def _end(node: YamlNode, key: str) -> WireEnd:
    def text(*path: str) -> str:
        child = node.get(*path)
        return "" if child is None or child.value is None else _text(child)

    if not node.is_mapping:
        return WireEnd("" if node.value is None else _text(node))
    limits = node.get("limits")
    pair = None
    if limits is not None:
        low, high, *_ = *(_text(number) for number in limits.elements()), "", ""
        pair = (low, high)
    return WireEnd(text(key), text("scale"), text("offset"), pair, text("unit"), text("follows"))


def _text(node: YamlNode) -> str:
    value = node.value
    return value if isinstance(value, str) else scalar_text(value) if not isinstance(value, tuple) else ""
