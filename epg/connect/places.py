# SPDX-License-Identifier: Apache-2.0
"""Finds the port and the component that a message is about, by its position."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from epg.generator.diagnostics import Diagnostic
from epg.generator.documents.tcf import TcfFile
from epg.generator.models.model import Model
from epg.generator.source import Span, YamlNode

_SECTIONS = ("inputs", "outputs")
MISSING = ("missing-key", "unwired")
"""The ids of messages about a missing key.  ``about`` is its path, below the component if it is a key of one."""

_Key = tuple[str, int, int, str]
"""The file, line and column at which a key begins, and its name; "" for a key that names no port or component."""


class Places:
    """The lines of the bindings that belong to ports, and the lines of the ``.tcf`` files that belong to components.

    They go from a name to the next one, or to the next key of the file.
    """

    def __init__(self, bindings: str, root: YamlNode | None, model: Model | None, chain: Sequence[TcfFile]) -> None:
        self._bindings = bindings
        self._ports = sorted(_keys(root, _SECTIONS)) if root is not None else []
        self._components = sorted(key for file in chain for key in _keys(file.node, ("components",)))
        nodes = [*(file.node for file in chain), *([root] if root is not None else [])]
        self._paths = sorted((place, path) for node in nodes for place, path in _paths(node, ()))
        ports = (*model.inputs, *model.outputs) if model is not None else ()
        spans = [port.span for port in ports]
        self._declared = {port.span: port.name for port in ports if port.span.line and spans.count(port.span) == 1}

    def port(self, diagnostic: Diagnostic) -> str | None:
        """The model port that a message is about; None if it is not about a port."""
        span = diagnostic.span
        section, _, name = diagnostic.about.partition(".") if diagnostic.id not in MISSING else ("", "", "")
        if section in _SECTIONS and span.file == self._bindings:
            return name
        return self._declared.get(span) or self.port_at(span)

    def port_at(self, span: Span) -> str | None:
        """The port whose lines in the bindings contain ``span``."""
        return _name(self._ports, span)

    def component(self, diagnostic: Diagnostic) -> str | None:
        """The component whose lines in a ``.tcf`` contain the position of a message."""
        return _name(self._components, diagnostic.span)

    def path(self, diagnostic: Diagnostic) -> list[str]:
        """The keys of the value in a ``.tcf``, or of the parameter in the bindings, that a message is about.

        Empty if it is about anything else.
        """
        span = diagnostic.span
        before = [path for place, path in self._paths if place[0] == span.file and place <= _place(span)]
        if not before or (span.file == self._bindings and before[-1][0] != "parameters"):
            return []
        if span.file == self._bindings:
            return list(before[-1][:2])
        if diagnostic.id not in MISSING or not diagnostic.about:
            return list(before[-1])
        return [*(before[-1][:2] if before[-1][0] == "components" else ()), *diagnostic.about.split(".")]


def _paths(node: YamlNode, above: tuple[str, ...]) -> Iterator[tuple[tuple[str, int, int], tuple[str, ...]]]:
    """The position of each key below ``node``, and the keys that lead to it."""
    for key, child in node.items():
        path = (*above, key)
        yield _place(node.key_span(key)), path
        yield from _paths(child, path)


def _place(span: Span) -> tuple[str, int, int]:
    return span.file, span.line, span.column


def _keys(root: YamlNode, sections: Sequence[str]) -> Iterator[_Key]:
    for parent, names in ((root, False), *((root[section], True) for section in sections if section in root)):
        for key, _ in parent.items():
            span = parent.key_span(key)
            yield span.file, span.line, span.column, key if names else ""


def _name(keys: Sequence[_Key], span: Span) -> str | None:
    """The name of the last key that does not begin behind ``span``."""
    before = [key for key in keys if key[0] == span.file and key[1:3] <= (span.line, span.column)]
    return before[-1][3] or None if before else None
