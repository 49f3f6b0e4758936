# SPDX-License-Identifier: Apache-2.0
"""Finds the port and the component that a message is about, by its position."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from epg.diagnostics import Diagnostic
from epg.documents.tcf import TcfFile
from epg.models.model import Model
from epg.source import Span, YamlNode

_SECTIONS = ("inputs", "outputs")


@dataclass(frozen=True)
class _Stretch:
    """The text from the first character of a key to the last character of its value."""

    name: str
    file: str
    first: tuple[int, int]
    last: tuple[int, int]

    def holds(self, span: Span) -> bool:
        return span.file == self.file and self.first <= (span.line, span.column) <= self.last


class Places:
    """The lines of the bindings that belong to ports, and the lines of the ``.tcf`` files that belong to components."""

    def __init__(self, bindings: str, root: YamlNode | None, model: Model | None, chain: Sequence[TcfFile]) -> None:
        self._bindings = bindings
        self._ports: list[_Stretch] = []
        for section in _SECTIONS:
            node = root.get(section) if root is not None else None
            self._ports += _stretches(node) if node is not None else []
        sections = [node for file in chain if (node := file.node.get("components")) is not None]
        self._components = [stretch for node in sections for stretch in _stretches(node)]
        ports = (*model.inputs, *model.outputs) if model is not None else ()
        spans = [port.span for port in ports]
        self._declared = {port.span: port.name for port in ports if port.span.line and spans.count(port.span) == 1}

    def port(self, diagnostic: Diagnostic) -> str | None:
        """The model port that a message is about; None if it is not about a port."""
        span = diagnostic.span
        section, _, name = diagnostic.about.partition(".")
        if section in _SECTIONS and span.file == self._bindings:
            return name
        return self._declared.get(span) or self.port_at(span)

    def port_at(self, span: Span) -> str | None:
        """The port whose lines in the bindings contain ``span``."""
        return _name(self._ports, span)

    def component(self, diagnostic: Diagnostic) -> str | None:
        """The component whose lines in a ``.tcf`` contain the position of a message."""
        return _name(self._components, diagnostic.span)


def _name(stretches: Sequence[_Stretch], span: Span) -> str | None:
    return next((stretch.name for stretch in stretches if stretch.holds(span)), None)


def _stretches(section: YamlNode) -> list[_Stretch]:
    found = []
    for name, value in section.items():
        key = section.key_span(name)
        ends = [(span.line, span.end - 1) for span in (key, *_spans(value)) if span.file == key.file]
        found.append(_Stretch(name, key.file, (key.line, key.column), max(ends)))
    return found


def _spans(node: YamlNode) -> Iterator[Span]:
    """The positions of a value and of everything in it."""
    yield node.span
    yield from node.keys.values()
    for _, child in node.items():
        yield from _spans(child)
    for child in node.elements():
        yield from _spans(child)
