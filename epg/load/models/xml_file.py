"""XML files of an export as trees whose elements know their line.

Document type declarations are refused, so entities cannot expand.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from xml.parsers import expat

from epg.diagnostics import Diagnostics
from epg.load.models.source_file import MAX_BYTES
from epg.source import Span

MAX_DEPTH = 64


@dataclass
class Element:
    """One element; ``text`` is all text directly inside it."""

    name: str
    attributes: dict[str, str]
    span: Span
    text: str = ""
    children: list[Element] = field(default_factory=list)

    def find(self, *path: str) -> Element | None:
        """The first element at ``path`` below this one."""
        element: Element | None = self
        for name in path:
            element = next((child for child in element.children if child.name == name), None) if element else None
        return element

    def text_of(self, *path: str) -> str:
        """The trimmed text at ``path``; empty when there is none."""
        element = self.find(*path)
        return element.text.strip() if element else ""


class _Refused(Exception):
    pass


def load_xml(path: Path, diagnostics: Diagnostics, *, required: bool = True) -> Element | None:
    """The root of the document at ``path``, or None after reporting what is wrong with it.

    Files that only add to what the sources say (``required`` false) give warnings instead of errors.
    """
    report = diagnostics.error if required else diagnostics.warning
    hint = "" if required else "it is ignored; export the model again"
    try:
        with path.open("rb") as file:
            data = file.read(MAX_BYTES + 1)
    except OSError as error:
        message = f"cannot read '{path.name}': {error.strerror or error}"
        report("model-unreadable", Span(str(path)), message, hint=hint or "check the file's permissions")
        return None
    if len(data) > MAX_BYTES:
        message = f"'{path.name}' is larger than {MAX_BYTES >> 20} MiB"
        report("model-unreadable", Span(str(path)), message, hint=hint or "is this the right file?")
        return None
    builder = _Builder(str(path))
    try:
        builder.parser.Parse(data, True)
    except expat.ExpatError as error:
        span = Span(str(path), error.lineno, error.offset + 1, error.offset + 2)
        report("model-xml", span, f"XML: {expat.ErrorString(error.code)}", hint=hint or "export the model again")
        return None
    except _Refused as error:
        report("model-xml", builder.span(1), str(error), hint=hint or "export the model again")
        return None
    except (ValueError, LookupError) as error:
        report("model-xml", Span(str(path), 1, 1, 2), f"XML: {error}", hint=hint or "export the model again")
        return None
    return builder.root


class _Builder:
    def __init__(self, file: str) -> None:
        self.file = file
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
        line, column = self.parser.CurrentLineNumber, self.parser.CurrentColumnNumber + 1
        return Span(self.file, line, column, column + length)

    def _start(self, name: str, attributes: dict[str, str]) -> None:
        if len(self.stack) >= MAX_DEPTH:
            raise _Refused(f"XML: elements nested deeper than {MAX_DEPTH} levels")
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
        raise _Refused("XML: document type declarations are not read")
