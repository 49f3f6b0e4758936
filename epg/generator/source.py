# SPDX-License-Identifier: Apache-2.0
"""Positions in the user's files, and values that know their position.

>>> span = Span("jiwy.tcf", 3, 8, 12)
>>> YamlNode("JIWY_node", span).plain()
'JIWY_node'
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import field
from types import MappingProxyType
from typing import Any, Union

from epg.generator.dataclass import dataclass

Scalar = Union[None, bool, int, float, str]
KeyPath = tuple[Union[str, int], ...]
"""The keys from the root of a document to one of its values: ``("components", "encoder_pan", "pins", "a")``."""


@dataclass(frozen=True)
class Span:
    """A part of one line of a file; ``line`` and ``column`` count from 1, ``end`` is one past the last column.

    ``line`` 0 means the file as a whole (missing, unreadable, binary).  Messages show ``text`` in place of the line of
    the file, if the value is not written in a file: an argument of a command, or of a CMake call.
    """

    file: str
    line: int = 0
    column: int = 0
    end: int = 0
    text: str | None = None

    @classmethod
    def of_argument(cls, value: str, option: str = "") -> Span:
        """The place of an argument of a command, after ``option`` if it belongs to one."""
        text = f"{option} {value}" if option else value
        return cls("command line", 1, len(text) - len(value) + 1, len(text) + 1, text=text)


@dataclass(frozen=True)
class YamlNode:
    """One value of a YAML document with its position.

    ``value`` is a scalar, a tuple of nodes or a mapping of names to nodes: a dict or a proxy of one.  For a mapping,
    ``keys`` holds the position of each key.  ``origins`` are the positions (innermost first) of the ``extends`` that
    lead to the file with this value.  A message about an inherited value shows them.
    """

    value: Scalar | tuple[YamlNode, ...] | Mapping[str, YamlNode]
    span: Span
    keys: Mapping[str, Span] = field(default_factory=lambda: MappingProxyType({}))
    origins: tuple[Span, ...] = ()

    @property
    def is_mapping(self) -> bool:
        return isinstance(self.value, (MappingProxyType, dict))

    @property
    def is_sequence(self) -> bool:
        return isinstance(self.value, tuple)

    def __contains__(self, key: object) -> bool:
        return isinstance(self.value, (MappingProxyType, dict)) and key in self.value

    def __getitem__(self, key: str | int) -> YamlNode:
        if isinstance(self.value, (MappingProxyType, dict)) and isinstance(key, str):
            child: YamlNode = self.value[key]
            return child
        if isinstance(self.value, tuple) and isinstance(key, int):
            return self.value[key]
        raise KeyError(key)

    def get(self, *path: str | int) -> YamlNode | None:
        """The value at ``path`` below this one, or None if a key of the path does not exist."""
        node: YamlNode = self
        for key in path:
            try:
                node = node[key]
            except (KeyError, IndexError):
                return None
        return node

    def items(self) -> Iterator[tuple[str, YamlNode]]:
        """Keys and values of a mapping in the order of the file; nothing for any other value."""
        if isinstance(self.value, (MappingProxyType, dict)):
            yield from self.value.items()

    def elements(self) -> tuple[YamlNode, ...]:
        """The elements of a sequence; nothing for any other value."""
        return self.value if isinstance(self.value, tuple) else ()

    def key_span(self, key: str) -> Span:
        """The position of ``key`` in this mapping; the position of the mapping if the key does not exist."""
        return self.keys.get(key, self.span)

    def plain(self) -> Any:
        """The value as dictionaries, lists and scalars without positions, for other libraries."""
        if isinstance(self.value, (MappingProxyType, dict)):
            return {key: node.plain() for key, node in self.value.items()}
        if isinstance(self.value, tuple):
            return [node.plain() for node in self.value]
        return self.value
