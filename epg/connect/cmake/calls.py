# SPDX-License-Identifier: Apache-2.0
"""Which epg_add_target() calls a project makes, found without running CMake.

Variables that are written in the files, or stand in the cache of an existing build folder, have values; everything else
is unknown.  Where a condition is unknown all its branches are walked, and what they set differently is unknown
afterwards.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from epg.connect.cmake.blocks import Block, Tree, commands_of, tree_of
from epg.connect.cmake.condition import condition
from epg.connect.cmake.syntax import Command, NotCMake, parse_cmake
from epg.connect.cmake.values import MAX_LENGTH, Variables, Word, expression
from epg.source import Span

MAX_COMMANDS = 20_000
"""Loops over loops end here, in a second or so."""
MAX_DEPTH = 8

# What these are given is no name of a variable that they write.
_READ_ONLY = re.compile(
    r"(message|include|install|export|project|(add|target|set|enable|link|pico|epg|zephyr|cmake_policy|cmake_minimum)_.*)$"
)


@dataclass(frozen=True)
class Call:
    """One call of a function of EPG; ``certain``: no unknown condition stands before it."""

    command: Command
    words: tuple[Word, ...]
    folder: Path
    variables: Variables
    certain: bool


@dataclass(frozen=True)
class Unknown:
    """A place that would have to be known, and why it is not."""

    span: Span
    message: str


class Walk:
    """The calls of the project whose top folder is ``top``; ``cache`` holds variables of a build folder."""

    def __init__(self, top: Path, cache: Mapping[str, str]) -> None:
        self.calls: list[Call] = []
        self.unknown: list[Unknown] = []
        self.uses_zephyr = False
        self._left = MAX_COMMANDS
        variables = Variables(cache)
        variables.set("CMAKE_SOURCE_DIR", top.as_posix())
        self._folder(top, variables, 0, True)

    def _folder(self, folder: Path, variables: Variables, depth: int, certain: bool) -> None:
        path = folder / "CMakeLists.txt"
        try:
            text = path.read_bytes().decode("utf-8-sig", "replace")
            tree = tree_of(parse_cmake(text, str(path)))
        except (OSError, ValueError):
            return  # CMake says so when it configures
        except NotCMake as problem:
            self.unknown.append(Unknown(problem.span, f"this is not understood: {problem}"))
            return
        for name in ("CMAKE_CURRENT_SOURCE_DIR", "CMAKE_CURRENT_LIST_DIR"):
            variables.set(name, folder.as_posix())
        variables.set("CMAKE_CURRENT_LIST_FILE", path.as_posix())
        try:
            _File(self, folder, depth).run(tree, variables, certain)
        except RecursionError:
            self.unknown.append(Unknown(Span(str(path)), "this is nested too deeply"))

    def enter(self, folder: Path, variables: Variables, depth: int, certain: bool) -> None:
        """What add_subdirectory() does."""
        if depth < MAX_DEPTH:
            self._folder(folder, variables.copy(), depth + 1, certain)

    def count(self) -> bool:
        """Whether one more command may be looked at."""
        self._left -= 1
        return self._left > 0


@dataclass
class _File:
    """The commands of one CMakeLists.txt."""

    walk: Walk
    folder: Path
    depth: int

    def run(self, tree: Tree, variables: Variables, certain: bool) -> bool:
        """Whether what comes after ``tree`` is reached: no return() was met."""
        for item in tree:
            if not self.walk.count():
                return False
            if isinstance(item, Block):
                going_on = self._block(item, variables, certain)
            else:
                going_on = item.name != "return" or not certain
                self._command(item, variables, certain)
            if not going_on:
                return False
        return True

    def _block(self, block: Block, variables: Variables, certain: bool) -> bool:
        opening, body = block.parts[0]
        if opening.name == "if":
            return self._if(block, variables, certain)
        if opening.name == "foreach":
            return self._foreach(opening, body, variables, certain)
        if opening.name == "block":
            return self.run(body, variables, certain)
        for command in commands_of(body):
            if command.name == "epg_add_target":
                message = f"this call stands in a {opening.name}(): only CMake knows when it is made"
                self.walk.unknown.append(Unknown(command.span, message))
            self._forget(command, variables)
        return True

    def _if(self, block: Block, variables: Variables, certain: bool) -> bool:
        ends: list[Variables] = []
        for command, body in block.parts:
            is_taken = command.name == "else" or _is_default(command, body, variables)
            known = is_taken or condition(command.arguments, variables)
            if known is False:
                continue
            if known and not ends:  # the only branch that is taken
                return self.run(body, variables, certain)
            end = variables.copy()
            self.run(body, end, False)
            ends.append(end)
            if known:
                break
        else:
            ends.append(variables.copy())  # no branch may be taken
        variables.become_any_of(ends)
        return True

    def _foreach(self, opening: Command, body: Tree, variables: Variables, certain: bool) -> bool:
        words = variables.words(opening.arguments)
        name, items = (words[0].text if words else None), words[1:]
        values: list[str | None] | None = [word.text for word in items]
        if items and items[0].text in ("IN", "RANGE"):
            values = _in_lists(items[1:], variables) if items[0].text == "IN" else None
        if name is None:
            return True
        if values is None or None in values:
            variables.set(name, None)
            return self.run(body, variables, False)
        for value in values:
            variables.set(name, value)
            self.run(body, variables, certain)
        return True

    def _command(self, command: Command, variables: Variables, certain: bool) -> None:
        words = variables.words(command.arguments)
        first = words[0].text if words else None
        if command.name in ("epg_add_target", "epg_add_executable"):
            self.walk.calls.append(Call(command, words, self.folder, variables.copy(), certain))
        elif command.name == "add_subdirectory":
            if first is not None:
                self.walk.enter(self.folder / first, variables, self.depth, certain)
            elif words:
                message = f"'{command.arguments[0].text}' is a folder that only CMake knows"
                self.walk.unknown.append(Unknown(words[0].span, message))
        elif command.name == "project":
            variables.set("PROJECT_SOURCE_DIR", self.folder.as_posix())
            variables.set("PROJECT_NAME", first)
        elif command.name == "find_package" and first == "Zephyr":
            self.walk.uses_zephyr = True
        elif command.name == "option" and first is not None:
            variables.set_cached(first, words[2].text if len(words) > 2 and certain else None, False)
        elif command.name == "string" and first == "REGEX" and len(words) == 6 and words[4].text:
            variables.set(words[4].text, _replaced(words[2].text, words[3].text, words[5].text))
        elif command.name in ("set", "unset") and first is not None:
            _set(command.name, first, words[1:], variables, certain)
        else:
            self._forget(command, variables)

    def _forget(self, command: Command, variables: Variables) -> None:
        """What a command is told by its name it may have changed."""
        if not _READ_ONLY.match(command.name):
            for argument in command.arguments:
                variables.forget(argument.text)


def _is_default(command: Command, body: Tree, variables: Variables) -> bool:
    """``if(NOT X)`` and ``if(NOT DEFINED X)`` around ``set(X ...)``, where nothing has set X before."""
    words = [argument.text for argument in command.arguments]
    if words[:1] != ["NOT"] or words[1:-1] not in ([], ["DEFINED"]) or variables.has(words[-1]):
        return False
    return any(
        inner.name == "set" and inner.arguments[:1] and inner.arguments[0].text == words[-1]
        for inner in commands_of(body)
    )


def _set(command: str, name: str, rest: Sequence[Word], variables: Variables, certain: bool) -> None:
    texts = [word.text for word in rest]
    if name.startswith(("ENV{", "CACHE{")) or "PARENT_SCOPE" in texts:
        return
    if command == "unset":
        variables.set(name, "")
        return
    cached = texts.index("CACHE") if "CACHE" in texts else None
    values = texts[:cached]
    known = [value for value in values if value is not None]
    joined = ";".join(known)
    value = joined if len(known) == len(values) and len(joined) <= MAX_LENGTH else None
    if cached is None:
        variables.set(name, value)
    else:
        variables.set_cached(name, value if certain else None, "FORCE" in texts)


def _replaced(pattern: str | None, replacement: str | None, text: str | None) -> str | None:
    """string(REGEX REPLACE) of expressions that mean the same to CMake and Python."""
    compiled = expression(pattern) if pattern is not None else None
    if compiled is None or replacement is None or text is None or len(text) > 300:
        return None
    try:
        return compiled.sub(replacement, text)
    except (re.error, IndexError):  # in the replacement
        return None


def _in_lists(items: Sequence[Word], variables: Variables) -> list[str | None] | None:
    """The values of ``IN LISTS <variable>... ITEMS <value>...``; None: unknown."""
    found: list[str | None] = []
    kind = ""
    for item in items:
        if item.text in ("LISTS", "ITEMS"):
            kind = item.text
        elif kind == "ITEMS":
            found.append(item.text)
        else:
            text = variables.get(item.text) if kind and item.text is not None else None
            if text is None:
                return None
            found += [part for part in text.split(";") if part]
    return found
