# SPDX-License-Identifier: Apache-2.0
"""Reads calls of EPG's functions with literal arguments from a CMakeLists.txt, without running CMake.

A literal argument may contain CMake's variables for the source folders.  A call with another variable, in a loop or
in a function is :class:`Unknown`: only CMake can evaluate it.  A call in if() counts as made.
Grammar: cmake-language(7), "Syntax".
"""

from __future__ import annotations

import os
import re
from collections.abc import Iterator, Mapping
from dataclasses import field
from pathlib import Path

from epg.generator.dataclass import dataclass
from epg.generator.source import Span

FILE = "CMakeLists.txt"
MAX_FOLDERS = 200
CALLS = ("epg_add_target", "epg_add_executable", "epg_add_simulation", "epg_add_system")

_TOKEN = re.compile(
    r"""(?P<space>[ \t\n;]+|\#\[(?P<c>=*)\[.*?\](?P=c)\]|\#(?!\[=*\[)[^\n]*)
    |(?P<paren>[()])
    |\[(?P<b>=*)\[\n?(?P<bracket>.*?)\](?P=b)\]
    |"(?P<quoted>(?:[^"\\]|\\.)*)"
    |(?P<plain>(?:[^\s()\#"\\;]|\\.)+)""",
    re.DOTALL | re.VERBOSE,
)
_REPEATING = re.compile(r"(end)?(?:foreach|while|function|macro)")


@dataclass(frozen=True)
class Word:
    """One argument.  ``text`` is its value, None if it is not literal; ``written`` is the text in the file."""

    text: str | None
    written: str
    span: Span


@dataclass(frozen=True)
class Call:
    """One call in the CMakeLists.txt of ``folder``.  ``roots`` are the folders of ``set(EPG_TARGETS_PATH ...)``."""

    name: str
    words: tuple[Word, ...]
    folder: Path
    roots: tuple[str, ...]
    span: Span


@dataclass(frozen=True)
class Unknown:
    """A place that only CMake can evaluate.  ``message`` says why.  Without ``hint``, configuring helps."""

    span: Span
    message: str
    hint: str = ""


def _tokens(text: str, path: Path) -> Iterator[tuple[re.Match[str] | None, str, Span]]:
    """The tokens of ``text`` without spaces and comments.  The first that is not complete is None, and the last."""
    at, line, before = 0, 1, 0
    while at < len(text):
        match = _TOKEN.match(text, at)
        start = at if match is None else match.start(match.lastgroup or 0)
        line, before = line + text.count("\n", before, start), start
        column = start - text.rfind("\n", 0, start)
        written = match[match.lastgroup or 0] if match else text[at]
        at = match.end() if match else len(text)
        if match is None or not match["space"]:
            yield match, written, Span(str(path), line, column, column + len(written.split("\n")[0] or " "))


def not_literal(word: Word) -> Unknown:
    return Unknown(word.span, f"only CMake can evaluate '{word.written}'")


@dataclass
class LiteralCalls:
    """The calls of the project in ``top``: in that folder and in all folders that add_subdirectory() names.

    ``drafts`` are the contents of files that are not saved yet; None for a file that will not exist.
    """

    top: Path
    drafts: Mapping[Path, bytes | None] = field(default_factory=dict)
    calls: list[Call] = field(default_factory=list)
    unknown: list[Unknown] = field(default_factory=list)
    uses_zephyr: bool = False
    _read: set[Path] = field(default_factory=set)

    def __post_init__(self) -> None:
        self._folder(self.top, ())

    def _folder(self, folder: Path, roots: tuple[str, ...]) -> None:
        path = folder / FILE
        try:
            data = self.drafts[path] if path in self.drafts else path.read_bytes()
        except (OSError, ValueError):
            return  # CMake reports it when it configures
        text = (data or b"").decode("utf-8-sig", "replace").replace("\r\n", "\n")
        if folder in self._read or len(self._read) >= MAX_FOLDERS:
            return
        self._read.add(folder)
        for name, span, words in self._outside_blocks(text, path):
            if name == "set" and words and words[0].text == "EPG_TARGETS_PATH":
                roots = tuple(root for word in words[1:] for root in (word.text or "").split(";"))
            else:
                self._command(Call(name, words, folder, roots, span))

    def _outside_blocks(self, text: str, path: Path) -> Iterator[tuple[str, Span, tuple[Word, ...]]]:
        """The commands that are carried out once.  The calls of targets inside loops and functions are reported."""
        blocks: list[str] = []
        for name, span, words in self._commands(text, path):
            block = _REPEATING.fullmatch(name)
            if block and block[1]:
                blocks = blocks[:-1]
            elif block:
                blocks.append(name)
            elif not blocks:
                yield name, span, words
            elif name == CALLS[0]:
                message = f"this call is inside {blocks[-1]}(): only CMake can evaluate it"
                self.unknown.append(Unknown(span, message))

    def _command(self, call: Call) -> None:
        first = call.words[0] if call.words else None
        if call.name in CALLS:
            self.calls.append(call)
        elif call.name == "find_package":
            self.uses_zephyr |= first is not None and first.text == "Zephyr"
        elif call.name == "add_subdirectory" and first is not None:
            if first.text is None:
                self.unknown.append(not_literal(first))
            else:
                self._folder(Path(os.path.normpath(call.folder / first.text)), call.roots)

    def _commands(self, text: str, path: Path) -> Iterator[tuple[str, Span, tuple[Word, ...]]]:
        """The commands of ``text``, their names in lower case.  The first syntax error is reported and ends them."""
        name, opening, words, depth = "", Span(str(path)), list[Word](), 0
        for match, written, span in _tokens(text, path):
            if match is None:
                self.unknown.append(Unknown(span, "the closing quote or bracket is missing"))
                return
            if match["paren"] == "(":
                depth += 1
            elif match["paren"] == ")" and depth:
                depth -= 1
                if not depth:
                    yield name, opening, tuple(words)
                    words = []
            elif depth:
                words.append(Word(self._text(match, path.parent), written, span))
            else:
                name, opening = written.lower(), span
        if depth:
            self.unknown.append(Unknown(opening, "the closing parenthesis is missing"))

    def _text(self, match: re.Match[str], folder: Path) -> str | None:
        """The value of an argument, or None if it is not literal."""
        if match["bracket"] is not None:
            return match["bracket"]
        text = match["quoted"] if match["quoted"] is not None else match["plain"]
        text = re.sub(r"\$\{CMAKE_CURRENT_(?:SOURCE|LIST)_DIR\}", lambda _: folder.as_posix(), text)
        text = re.sub(r"\$\{(?:CMAKE|PROJECT)_SOURCE_DIR\}", lambda _: self.top.as_posix(), text)
        return None if re.search(r"\$(?:ENV|CACHE)?\{|\\[A-Za-z]", text) else re.sub(r"\\(.)", r"\1", text)
