# SPDX-License-Identifier: Apache-2.0
"""Values of YAML nodes as Python types, for the files of ``targets/``.  A schema has checked their structure before."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Mapping
from dataclasses import fields
from types import MappingProxyType
from typing import Any

from epg.generator.source import YamlNode

_RANGE = re.compile(r"([A-Za-z_]*)([0-9]+)-([A-Za-z_]*)([0-9]+)")


def text_of(node: YamlNode, *path: str) -> str:
    """The text at ``path``; empty if it is missing."""
    value = node.get(*path)
    return "" if value is None else str(value.value)


def flag_of(node: YamlNode, *path: str) -> bool:
    """The boolean at ``path``; false if it is missing."""
    value = node.get(*path)
    return value is not None and value.value is True


def integer_of(node: YamlNode, *path: str) -> int | None:
    """The whole number at ``path``; None if it is missing, or another value."""
    value = node.get(*path)
    return value.value if value is not None and isinstance(value.value, int) else None


def elements_of(node: YamlNode, *path: str) -> tuple[YamlNode, ...]:
    """The elements of the list at ``path``; empty if it is missing."""
    value = node.get(*path)
    return () if value is None else value.elements()


def texts_of(node: YamlNode, *path: str) -> tuple[str, ...]:
    """The elements of the list at ``path`` as text; empty if it is missing."""
    return tuple(str(element.value) for element in elements_of(node, *path))


def map_of(node: YamlNode, *path: str) -> dict[str, YamlNode]:
    """The entries of the map at ``path``; empty if it is missing."""
    value = node.get(*path)
    return {} if value is None else dict(value.items())


def text_map_of(node: YamlNode, *path: str) -> Mapping[str, str]:
    """The entries of the map at ``path`` as text; empty if it is missing."""
    return MappingProxyType({key: str(value.value) for key, value in map_of(node, *path).items()})


_READERS: Mapping[object, Callable[[YamlNode, str], object]] = {
    "str": text_of,
    "bool": flag_of,
    "tuple[str, ...]": texts_of,
    "Mapping[str, str]": text_map_of,
}


def values_of(node: YamlNode, into: type) -> dict[str, Any]:
    """The values for the fields of the dataclass ``into`` that are keys of ``node``, for fields of these types.

    A field of another type, or of another name than its key, is left out or empty: the caller must replace it.
    """
    return {field.name: _READERS[field.type](node, field.name) for field in fields(into) if field.type in _READERS}


def pin_names(node: YamlNode | None) -> tuple[str, ...]:
    """All pins of a list of pins and ranges: ``[0-2, 7]`` gives 0, 1, 2 and 7, ``[PA0-PA15]`` sixteen.

    Raises ValueError for a wrong range: one that runs backwards, between different ports, or over more than 256 pins.
    """
    names: list[str] = []
    for element in node.elements() if node is not None else ():
        text = str(element.value)
        match = _RANGE.fullmatch(text)
        if match is None:
            names.append(text)
            continue
        prefix, first, other, last = match[1], int(match[2]), match[3], int(match[4])
        if other != prefix or last < first or last - first > 255:
            raise ValueError(f"'{text}' is not a range of pins")
        names.extend(f"{prefix}{number}" for number in range(first, last + 1))
    return tuple(names)


def pin_list(pins: Iterable[str]) -> str:
    """A list of pins for messages, with three or more successive pins as a range: ``0-3, 6, PA0-PA15``."""
    parts: list[list[str]] = []
    for pin in pins:
        if parts and _follows(parts[-1][-1], pin):
            parts[-1].append(pin)
        else:
            parts.append([pin])
    return ", ".join(f"{run[0]}-{run[-1]}" if len(run) > 2 else ", ".join(run) for run in parts)


def _follows(one: str, other: str) -> bool:
    first, second = re.fullmatch(r"(\D*)(\d+)", one), re.fullmatch(r"(\D*)(\d+)", other)
    return bool(first and second and first[1] == second[1] and int(second[2]) == int(first[2]) + 1)


def integer_range(node: YamlNode) -> tuple[int, int]:
    """The first and the last number of a range such as ``1-255``."""
    first, _, last = str(node.value).partition("-")
    return int(first), int(last)
