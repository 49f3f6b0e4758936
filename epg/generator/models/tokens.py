# SPDX-License-Identifier: Apache-2.0
"""Reads ``tokens.xml``: all values and equations that 20-sim fills into its templates, by name.

Lists such as ``INPUT_NAMES3`` and ``INPUT_UNITS`` have one entry on each line; a missing entry is an empty line.
``*_NAMES3`` are plain names.  ``*_NAMES`` are C strings; they are used for old versions that do not write plain names.
"""

from __future__ import annotations

import re
from pathlib import Path

from epg.generator.dataclass import dataclass
from epg.generator.diagnostics import Diagnostics
from epg.generator.documents.source_file import STRING, SourceFile
from epg.generator.documents.xml_file import load_xml
from epg.generator.source import Span

_CDATA = "<![CDATA["


@dataclass(frozen=True)
class Token:
    """One token.  ``span`` is the place where its value begins."""

    value: str
    span: Span


@dataclass(frozen=True)
class Tokens:
    """The tokens of one export."""

    path: Path
    values: dict[str, Token]

    def get(self, name: str, default: str = "") -> str:
        token = self.values.get(name)
        return token.value if token else default

    def trimmed(self, name: str) -> str:
        return self.get(name).strip()

    def count(self, name: str) -> int:
        """The number in token ``name``; 0 if it does not exist or is not a number."""
        text = self.trimmed(name)
        return int(text) if re.fullmatch(r"[0-9]{1,9}", text) else 0

    def span(self, name: str) -> Span:
        token = self.values.get(name)
        return token.span if token else Span(str(self.path), 1, 1, 2)

    def names(self, kind: str) -> list[str]:
        """The names of ``kind`` ("INPUT", "PARAMETER", ...) in the order of their array."""
        if f"{kind}_NAMES3" in self.values:
            return [name.strip() for name in self._lines(f"{kind}_NAMES3")]
        return [re.sub(r"\\(.)", r"\1", match[1]) for match in STRING.finditer(self.get(f"{kind}_NAMES"))]

    def named(self, kind: str) -> list[tuple[str, Span]]:
        """The names of ``kind``, each with the position of the list."""
        return [(name, self.span(f"{kind}_NAMES3")) for name in self.names(kind)]

    def units(self, kind: str, count: int) -> list[str]:
        """The units of ``kind``, always ``count`` of them.  A missing unit is empty."""
        units = [unit.strip() for unit in self._lines(f"{kind}_UNITS")]
        return (units + [""] * count)[:count]

    def lines(self, name: str) -> list[tuple[str, Span]]:
        """The lines of a token that has one value on each line, with their places."""
        first = self.span(name)
        spans = (first, *(Span(first.file, first.line + at, 1, 2) for at in range(1, len(self._lines(name)))))
        return list(zip(self._lines(name), spans))

    def _lines(self, name: str) -> list[str]:
        text = self.get(name)
        if text.endswith("\n"):
            text = text[:-1]
        elif not text:
            return []
        return text.split("\n")

    def code(self, name: str) -> SourceFile:
        """The code in a token, padded so that lines and columns in it are those in ``tokens.xml``."""
        token = self.values.get(name)
        if token is None:
            return SourceFile(self.path, "")
        lead = "\n" * max(0, token.span.line - 1) + " " * max(0, token.span.column - 1)
        return SourceFile(self.path, lead + token.value)


def is_tokens_file(path: Path) -> bool:
    """True if a file has a name that 20-sim gives to tokens files: ``tokens.xml``, ``Controller_tokens.xml``."""
    return path.suffix.lower() == ".xml" and path.stem.lower().endswith("tokens")


def load_tokens(path: Path, diagnostics: Diagnostics, *, required: bool) -> Tokens | None:
    """The tokens in ``path``.  None if the file is wrong; this is an error if ``required``, else a warning."""
    root = load_xml(path, diagnostics, required=required)
    if root is None:
        return None
    if root.name != "tokens":
        report = diagnostics.error if required else diagnostics.warning
        message = f"this is not a tokens file of 20-sim: its root is <{root.name}>"
        report("model-xml", root.span, message, hint="the root of a tokens file is <tokens>")
        return None
    values: dict[str, Token] = {}
    for element in root.children:
        name = element.attributes.get("name", "")
        if element.name == "token" and name:
            line, column = element.span.line, element.span.column
            column += len(f'<token name="{name}">{_CDATA}')
            values[name] = Token(element.text, Span(element.span.file, line, column, column + 1))
    return Tokens(path, values)
