# SPDX-License-Identifier: Apache-2.0
"""XML files of an export as trees of elements with positions.

Document type declarations are refused.  Thus a file cannot define entities that expand to enormous texts.
"""

from __future__ import annotations

from dataclasses import field
from pathlib import Path
from xml.parsers import expat

from epg.generator.dataclass import dataclass
from epg.generator.diagnostics import Diagnostics, Note
from epg.generator.documents.source_file import decode, read_bytes
from epg.generator.documents.text_file import one_line
from epg.generator.source import Span

MAX_DEPTH = 64
MAX_ELEMENTS = 250_000
_ENDS = ("no element found", "unclosed token", "unclosed CDATA section", "partial character")  # Messages of expat.
_IGNORED = "EPG ignores the file; export the model again"


@dataclass
class Element:
    """One element; ``text`` is its text without the text of its children."""

    name: str
    attributes: dict[str, str]
    span: Span
    text: str = ""
    children: list[Element] = field(default_factory=list)

    def find(self, *path: str) -> Element | None:
        """The first element at ``path`` below this one, or None."""
        element: Element | None = self
        for name in path:
            element = next((child for child in element.children if child.name == name), None) if element else None
        return element

    def text_of(self, *path: str) -> str:
        """The trimmed text of the element at ``path``; empty if there is no such element."""
        element = self.find(*path)
        return element.text.strip() if element else ""


class _Refused(Exception):
    pass


def load_xml(path: Path, diagnostics: Diagnostics, *, required: bool = True) -> Element | None:
    """The root of the document at ``path``, or None after reporting mistakes.

    ``required`` is False for files that EPG can do without, because the sources hold the same data.  Their mistakes are
    reported as warnings.
    """
    report = diagnostics.error if required else diagnostics.warning

    def unreadable(message: str, hint: str) -> None:
        report("model-unreadable", Span(str(path)), message, hint=hint if required else _IGNORED)

    data = read_bytes(path, unreadable)
    if data is None:
        return None
    return parse_xml(data, Span(str(path)), diagnostics, required=required)


def parse_xml(
    data: bytes, whole: Span, diagnostics: Diagnostics, *, required: bool = True, hint: str = "", shown: bool = False
) -> Element | None:
    """The root of the document ``data``, or None after reporting mistakes, as :func:`load_xml`.

    ``whole`` names the file in messages.  Set ``shown`` for a document in an archive: its positions then hold the text
    of their line.  ``hint`` replaces the usual hint.
    """
    report = diagnostics.error if required else diagnostics.warning
    hint = hint or ("export the model again" if required else _IGNORED)
    builder = _Builder(whole.file, decode(data).split("\n") if shown else None)
    try:
        builder.parser.Parse(data, True)
    except expat.ExpatError as error:
        span = builder.at(error.lineno, error.offset + 1, 1)
        reason = expat.ErrorString(error.code)
        if reason in _ENDS and builder.stack:
            element = builder.stack[-1]
            name = element.attributes.get("name", "")
            which = f"<{element.name}>" + (f" '{one_line(name)[:80]}'" if name else "")
            message = f"XML: the file ends before {which} does: a part of it is missing"
            report("model-xml", span, message, hint=hint, notes=[Note(f"{which} begins here", element.span)])
        else:
            report("model-xml", span, f"XML: {reason}", hint=hint)
        return None
    except _Refused as error:
        report("model-xml", builder.span(1), str(error), hint=hint)
        return None
    except (ValueError, LookupError) as error:
        report("model-xml", builder.at(1, 1, 1), f"XML: {error}", hint=hint)
        return None
    return builder.root


class _Builder:
    """Builds the tree from the events of expat's parser.  Raises :class:`_Refused` for documents that are too large."""

    def __init__(self, file: str, lines: list[str] | None = None) -> None:
        self.file = file
        self.lines = lines
        self.count = 0
        self.root: Element | None = None
        self.stack: list[Element] = []
        self.texts: list[list[str]] = []
        self.parser = expat.ParserCreate()
        self.parser.buffer_text = True
        self.parser.StartElementHandler = self._start
        self.parser.EndElementHandler = self._end
        self.parser.CharacterDataHandler = self._text
        self.parser.StartDoctypeDeclHandler = self._doctype

    def span(self, length: int) -> Span:
        return self.at(self.parser.CurrentLineNumber, self.parser.CurrentColumnNumber + 1, length)

    def at(self, line: int, column: int, length: int) -> Span:
        text = self.lines[line - 1] if self.lines is not None and 0 < line <= len(self.lines) else None
        return Span(self.file, line, column, column + length, text)

    def _start(self, name: str, attributes: dict[str, str]) -> None:
        if len(self.stack) >= MAX_DEPTH:
            raise _Refused(f"XML: elements nested deeper than {MAX_DEPTH} levels")
        self.count += 1
        if self.count > MAX_ELEMENTS:
            raise _Refused(f"XML: more than {MAX_ELEMENTS} elements")
        element = Element(name, attributes, self.span(len(name) + 1))
        if self.stack:
            self.stack[-1].children.append(element)
        else:
            self.root = element
        self.stack.append(element)
        self.texts.append([])

    def _end(self, _name: str) -> None:
        self.stack.pop().text = "".join(self.texts.pop())

    def _text(self, data: str) -> None:
        if self.texts:
            self.texts[-1].append(data)

    def _doctype(self, *_arguments: object) -> None:
        raise _Refused("XML: EPG does not read document type declarations")
