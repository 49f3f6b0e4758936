# SPDX-License-Identifier: Apache-2.0
"""The commands of a CMakeLists.txt as they are written, with positions; nothing is evaluated.

>>> [command.name for command in parse_cmake("project(jiwy C) # a robot", "CMakeLists.txt")]
['project']

Source of the grammar: cmake-language(7), section "Syntax".
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass

from epg.source import Span


@dataclass(frozen=True)
class Argument:
    """One argument: ``text`` without its delimiters, escapes and ``${}`` still in it.

    ``form`` is "plain", "quoted" or "bracket"; a parenthesis within the arguments is a "plain" one.
    """

    text: str
    form: str
    span: Span


@dataclass(frozen=True)
class Command:
    """``name`` is in lower case, as CMake takes it; ``span`` is that of the name."""

    name: str
    arguments: tuple[Argument, ...]
    span: Span


class NotCMake(Exception):
    """The text is not what CMake would read; ``span`` says where that begins."""

    def __init__(self, message: str, span: Span) -> None:
        super().__init__(message)
        self.span = span


_SPACE = re.compile(r"(?:[ \t\n]+|#\[(=*)\[.*?\]\1\]|#(?!\[=*\[)[^\n]*)*", re.DOTALL)
_NAME = re.compile(r"[A-Za-z_]\w*")
_BRACKET = re.compile(r"\[(=*)\[\n?(.*?)\]\1\]", re.DOTALL)
_QUOTED = re.compile(r'"((?:[^"\\]|\\.)*)"', re.DOTALL)
# With the quoted stretches and make-style references that old files have within one: -D"a b", $(HOME)
_PLAIN = re.compile(r'(?:[^\s()#"\\]|\\[^\n]|\$\([^\s()]*\)|(?<=\S)"(?:[^"\\]|\\.)*")+')


def parse_cmake(text: str, file: str) -> list[Command]:
    """All commands of ``text``.  Raises :class:`NotCMake`."""
    return list(_Reader(text.replace("\r\n", "\n"), file).commands())


class _Reader:
    def __init__(self, text: str, file: str) -> None:
        self.text, self.file = text, file
        self.at = 0
        self.starts = [0, *(match.end() for match in re.finditer("\n", text))]
        self.line = 0  # of the position that was asked for last: they only grow

    def commands(self) -> Iterator[Command]:
        self._skip_space()
        while self.at < len(self.text):
            name = self._take(_NAME, "the name of a command")
            self._skip_space()
            if self.text[self.at : self.at + 1] != "(":
                raise NotCMake(f"'{name[0]}' needs its arguments in parentheses", self._span(*name.span()))
            self.at += 1
            arguments = tuple(self._arguments())
            yield Command(name[0].lower(), arguments, self._span(*name.span()))
            self._skip_space()

    def _arguments(self) -> Iterator[Argument]:
        opening, depth = self.at - 1, 1
        while True:
            self._skip_space()
            start, char = self.at, self.text[self.at : self.at + 1]
            if not char:
                raise NotCMake("this parenthesis is not closed", self._span(opening, opening + 1))
            if char in "()":
                self.at += 1
                depth += 1 if char == "(" else -1
                if not depth:
                    return
                yield Argument(char, "plain", self._span(start, self.at))
            elif match := _BRACKET.match(self.text, start):
                self.at = match.end()
                yield Argument(match[2], "bracket", self._span(*match.span()))
            elif char == '"':
                match = self._take(_QUOTED, "a closing quote")
                yield Argument(match[1], "quoted", self._span(*match.span(1)))
            else:
                match = self._take(_PLAIN, "an argument")
                yield Argument(match[0], "plain", self._span(*match.span()))

    def _skip_space(self) -> None:
        match = _SPACE.match(self.text, self.at)
        assert match is not None, "it matches nothing too"
        self.at = match.end()

    def _take(self, pattern: re.Pattern[str], wanted: str) -> re.Match[str]:
        match = pattern.match(self.text, self.at)
        if match is None:
            raise NotCMake(f"CMake expects {wanted} here", self._span(self.at, self.at + 1))
        self.at = match.end()
        return match

    def _span(self, start: int, end: int) -> Span:
        """Of one line: what goes on over the end of its line is shown up to there."""
        while self.line and self.starts[self.line] > start:
            self.line -= 1
        while self.line + 1 < len(self.starts) and self.starts[self.line + 1] <= start:
            self.line += 1
        first = self.starts[self.line]
        stop = self.starts[self.line + 1] - 1 if self.line + 1 < len(self.starts) else len(self.text)
        return Span(self.file, self.line + 1, start - first + 1, min(end, stop) - first + 1)
