# SPDX-License-Identifier: Apache-2.0
"""Reads the keys and values of a project file of STM32CubeMX (``.ioc``), with their positions.

The file is a list of Java properties: ``key=value`` lines in any order, with escapes such as ``\\:``, ``\\#`` and
``\\ `` (``java.util.Properties.load``).  Programs other than CubeMX can have edited it.  This reader does not know what
keys mean.

>>> # ioc = read_ioc(Path("robot.ioc"), diagnostics)
>>> # ioc["PD12.Signal"].value
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from pathlib import Path

from epg.generator.dataclass import dataclass
from epg.generator.diagnostics import Diagnostics
from epg.generator.documents.text_file import NO_DRAFTS, Drafts, one_line, read_text
from epg.generator.source import Span

_COMMENT = re.compile(r"[ \t\f]*[#!]")
_ENDS = re.compile(r"\r\n|\r|\n")  # Not str.splitlines(): a form feed or U+2028 does not end a line of properties.
_KEY = re.compile(r"[ \t\f]*((?:[^\\=: \t\f]|\\.?)*)[ \t\f]*[=:]?[ \t\f]*", re.DOTALL)
_ESCAPE = re.compile(r"\\(?:u([0-9A-Fa-f]{4})|(.?))", re.DOTALL)
_CHARACTERS = {"t": "\t", "n": "\n", "r": "\r", "f": "\f"}


@dataclass(frozen=True)
class IocEntry:
    """The value of a key, without escapes, and its position.  Control characters are replaced by ``?``."""

    value: str
    span: Span


@dataclass(frozen=True)
class Ioc:
    """The entries of an ``.ioc``: key without escapes -> entry.  Of several lines with one key, the last one counts."""

    path: Path
    entries: Mapping[str, IocEntry]

    def value(self, key: str) -> str:
        """The value of ``key``; empty if the key does not exist."""
        return self.entries[key].value if key in self.entries else ""

    def matching(self, pattern: str) -> Iterator[tuple[re.Match[str], IocEntry]]:
        """The entries whose whole key matches, in the order of the file."""
        for key, entry in self.entries.items():
            match = re.fullmatch(pattern, key)
            if match is not None:
                yield match, entry


def read_ioc(
    path: Path, diagnostics: Diagnostics, wanted_by: Span | None = None, drafts: Drafts = NO_DRAFTS
) -> Ioc | None:
    """The entries of ``path``, or None after reporting that the file cannot be read.

    ``wanted_by`` is the position at which the name of the file is written.
    """
    text = read_text(path, diagnostics, wanted_by, drafts)
    if text is None:
        return None
    entries: dict[str, IocEntry] = {}
    lines = _ENDS.split(text)
    number = 0
    while number < len(lines):
        first, line = number + 1, lines[number]
        number += 1
        if not line.strip(" \t\f") or _COMMENT.match(line):
            continue
        length = len(line)
        parts = [line]
        while _continues(parts[-1]) and number < len(lines):
            parts[-1] = parts[-1][:-1]
            parts.append(lines[number].lstrip(" \t\f"))
            number += 1
        joined = "".join(parts)
        match = _KEY.match(joined)
        assert match is not None
        start = min(match.end(), length) + 1
        span = Span(str(path), first, start, max(start, length) + 1 if start > length else length + 1)
        entries.pop(_plain(match[1]), None)  # Dictionaries keep the first position of a key.
        entries[_plain(match[1])] = IocEntry(_plain(joined[match.end() :]), span)
    return Ioc(path, entries)


def _continues(line: str) -> bool:
    """True if the line ends with an odd number of backslashes: the next line continues it."""
    return (len(line) - len(line.rstrip("\\"))) % 2 == 1


def _plain(text: str) -> str:
    """A key or value without escapes."""
    if "\\" in text:
        text = _ESCAPE.sub(
            lambda match: chr(int(match[1], 16)) if match[1] else _CHARACTERS.get(match[2], match[2]), text
        )
    return one_line(text)
