# SPDX-License-Identifier: Apache-2.0
"""Values of CMake's variables as far as they can be known without running it.

>>> variables = Variables({})
>>> variables.set("board", "pico")
>>> variables.expand("rpi_${board}"), variables.expand("${nobody_knows}")
('rpi_pico', None)

None is a value that is not known.
"""

from __future__ import annotations

import os
import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

from epg.connect.cmake.syntax import Argument
from epg.source import Span

_REFERENCE = re.compile(r"\$(ENV|CACHE)?\{")
MAX_LENGTH = 10_000
"""Longer values are not known: they could double with every line."""
_NOT_PYTHONS = re.compile(r"\(\?|[*+?}][?+]|\[\[|\\[A-Za-z0-9]")
_REPEATED_GROUP = re.compile(r"\)[*+?]")
"""Could take Python for ever."""
_NAME = re.compile(r"[A-Za-z_]\w*")
_SEMICOLON = "\0"
"""Stands for ``\\;``, which separates no elements."""
_ESCAPES = {"t": "\t", "n": "\n", "r": "\r", ";": _SEMICOLON, "\n": ""}  # the last: a line that goes on


@dataclass(frozen=True)
class Word:
    """One value that a command is called with; ``written`` is the argument it comes of."""

    text: str | None
    written: str
    span: Span


def expression(pattern: str) -> re.Pattern[str] | None:
    """A regular expression that means the same to CMake and to Python, or None."""
    if _NOT_PYTHONS.search(pattern) or _REPEATED_GROUP.search(pattern):
        return None
    try:
        return re.compile(pattern)
    except re.error:
        return None


class Variables:
    """Variables of one directory scope; ``cache`` are those of a build folder, which the scopes below share."""

    def __init__(self, cache: Mapping[str, str]) -> None:
        self._cache: dict[str, str | None] = dict(cache)
        self._from_build = frozenset(cache)
        self._values: dict[str, str | None] = {}

    def copy(self) -> Variables:
        other = Variables({})
        other._cache, other._from_build = self._cache, self._from_build
        other._values = dict(self._values)
        return other

    def get(self, name: str) -> str | None:
        return self._values[name] if name in self._values else self._cache.get(name)

    def has(self, name: str) -> bool:
        """Whether something has set this variable, or may have, to a value that is known or not."""
        return name in self._values or name in self._cache

    def set(self, name: str, value: str | None) -> None:
        self._values[name] = value

    def set_cached(self, name: str, value: str | None, force: bool) -> None:
        """As set(... CACHE ...): what a build folder says wins unless FORCE is written, which may be conditional."""
        if name in self._from_build:
            return
        if name not in self._cache or force:
            self._cache[name] = value

    def forget(self, name: str) -> None:
        """Makes unknown what may be the name of a variable."""
        if _NAME.fullmatch(name):
            self._values[name] = None

    def become_any_of(self, others: Iterable[Variables]) -> None:
        """Keeps the values that all of ``others`` have."""
        all_values = [other._values for other in others]
        names = {name for values in all_values for name in values}
        missing = object()
        for name in names:
            found = {values.get(name, missing) for values in all_values}
            value = found.pop()
            self._values[name] = value if not found and (value is None or isinstance(value, str)) else None

    def words(self, arguments: Sequence[Argument]) -> tuple[Word, ...]:
        """What a command is called with: variables replaced, lists of unquoted arguments taken apart."""
        words = []
        for argument in arguments:
            text = argument.text if argument.form == "bracket" else self.expand(argument.text)
            parts = [text] if text is None or argument.form != "plain" else [p for p in text.split(";") if p]
            for part in parts:
                value = None if part is None else part.replace(_SEMICOLON, ";")
                words.append(Word(value, argument.text, argument.span))
        return tuple(words)

    def expand(self, text: str) -> str | None:
        """``text`` with its escapes and references replaced, or None when a variable in it is not known."""
        return self._expand(text, 0, "")[0]

    def _expand(self, text: str, at: int, closing: str) -> tuple[str | None, int]:
        """The value up to ``closing``, and the position after it."""
        found: list[str] = []
        known = True
        while at < len(text):
            if text[at] == closing:
                at += 1
                break
            if text[at] == "\\" and at + 1 < len(text):
                found.append(_ESCAPES.get(text[at + 1], text[at + 1]))
                at += 2
            elif match := _REFERENCE.match(text, at):
                name, at = self._expand(text, match.end(), "}")
                value = None if name is None else self._refer(match[1], name)
                known = known and value is not None
                found.append(value or "")
            else:
                found.append(text[at])
                at += 1
        value = "".join(found)
        return (value if known and len(value) <= MAX_LENGTH else None), at

    def _refer(self, where: str | None, name: str) -> str | None:
        if where == "ENV":
            return os.environ.get(name, "")
        return self._cache.get(name) if where == "CACHE" else self.get(name)
