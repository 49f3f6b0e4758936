# SPDX-License-Identifier: Apache-2.0
"""Decides which parts of C files a compiler sees: ``#if``, ``#ifdef``, ``#else``, in the order of ``#include``.

A unit and the files that it includes are one sequence of directives.  Each part of a file has the condition under which
it is compiled, or one of several if the file is included several times.  ``conditions.py`` evaluates the conditions.
"""

from __future__ import annotations

import re
from bisect import bisect_left
from collections.abc import Callable, Iterable, Mapping
from dataclasses import replace

from epg.generator.dataclass import dataclass
from epg.generator.documents.source_file import SourceFile
from epg.generator.models.c_code import Include, includes
from epg.generator.models.conditions import NO, OPEN, YES, DefinedMacros, both, condition_of, either, inverse

_DIRECTIVE = re.compile(
    r"^[ \t]*#[ \t]*(ifdef|ifndef|if|elif|else|endif|define|undef|include|pragma)\b((?:\\\n|[^\n])*)", re.MULTILINE
)
_NAME = re.compile(r"\s*([A-Za-z_]\w*)", re.ASCII)
_NOT_DEFINED = re.compile(r"\s*!\s*defined\b\s*(?:\(\s*([A-Za-z_]\w*)\s*\)|([A-Za-z_]\w*))\s*", re.ASCII)
_DEEPEST = 60  # levels of #include
_MOST_FILES = 20_000  # files of a unit, each as often as it is included
_MOST_WORK = 20_000_000  # directives in the files of all units; long expressions count several times


@dataclass(frozen=True)
class ConditionalSection:
    """A part of a file between two conditional directives, by offsets, and the condition under which it is compiled.

    ``directive`` is the offset of the directive that begins the part; -1 for the first part of a file.
    """

    start: int
    end: int
    directive: int
    condition: str


@dataclass(frozen=True)
class _Directive:
    kind: str
    text: str
    start: int
    end: int
    include: Include | None = None


@dataclass
class _Group:
    """An ``#if`` up to its ``#endif``: the conditions around it, of its branches so far, and of the current branch."""

    around: str
    before: str
    now: str


class TooManyFiles(Exception):
    """The files include each other without end, or too many files are included; the message says which of both."""


class Preprocessor:
    """Goes through units and the files that they include, and keeps the condition of each part of them.

    ``read(name)`` returns a file; ``find(name, include, condition)`` the name of the file that an ``#include`` in the
    file ``name`` means, or None.  Raises TooManyFiles if the files include each other without end, or if there is more
    work than the FMU of any controller needs.  ``work`` is the work of other runs, which counts, too.
    """

    def __init__(
        self, read: Callable[[str], SourceFile], find: Callable[[str, Include, str], str | None], work: int = 0
    ) -> None:
        self._read = read
        self._find = find
        self.included: dict[str, str] = {}  # included files, and the condition under which one of them is included
        self._directives: dict[str, list[_Directive]] = {}
        self._conditions: dict[str, list[str]] = {}
        self._once: dict[str, str] = {}  # files with #pragma once, and the condition under which they are left out now
        self._weights: dict[str, int] = {}
        self._guards: dict[tuple[str, int], bool] = {}  # answers of _is_guard()
        self._count = 0  # files of this unit
        self.work = work

    def add(self, unit: str, macros: Mapping[str, str]) -> None:
        """Goes through a unit that is compiled with ``macros``."""
        self._count = 0
        self._once = {}
        self._walk(unit, DefinedMacros(macros), YES, 0)

    def names(self) -> list[str]:
        return sorted(self._conditions)

    def parts(self, name: str) -> list[ConditionalSection]:
        """The parts of the file ``name``."""
        conditions = iter(self._conditions[name])
        parts = [ConditionalSection(0, 0, -1, next(conditions))]
        for directive in self._directives[name]:
            if directive.kind in _CONDITIONAL:
                parts[-1] = replace(parts[-1], end=directive.start)
                parts.append(ConditionalSection(directive.end, 0, directive.start, next(conditions)))
        parts[-1] = replace(parts[-1], end=len(self._read(name).text))
        return parts

    def _walk(self, name: str, table: DefinedMacros, outside: str, depth: int) -> None:
        self._count += 1
        if depth > _DEEPEST or self._count > _MOST_FILES:
            raise TooManyFiles("files of the FMU include each other without end")
        if name not in self._directives:
            self._scan(name)
        self.work += self._weights[name]
        if self.work > _MOST_WORK:
            raise TooManyFiles("the FMU includes too many files")
        once = None
        conditions = self._conditions[name]
        groups: list[_Group] = []
        active, part = outside, 0
        conditions[0] = either(conditions[0], active)
        for index, directive in enumerate(self._directives[name]):
            if directive.kind in _CONDITIONAL:
                guard = self._is_guard(name, index)
                _conditional(directive, groups, active, table, guard)
                active = both(groups[-1].around, groups[-1].now) if groups else outside
                part += 1
                conditions[part] = either(conditions[part], active)
            elif active == NO:
                continue
            elif directive.include is not None:
                included = self._find(name, directive.include, active)
                if included is not None:
                    self.included[included] = either(self.included.get(included, NO), active)
                    self._walk(included, table, active, depth + 1)
            elif directive.kind == "pragma":
                before = self._once.get(name, NO)
                if before in (YES, active):
                    return
                once = either(before, active)
                self._once[name] = YES  # for the files that this one includes
            else:
                _change(directive, table, active)
        if once is not None:
            self._once[name] = once

    def _scan(self, name: str) -> None:
        """Reads the directives of a file."""
        directives = _of_file(self._read(name))
        self._directives[name] = directives
        self._conditions[name] = [NO] * (1 + sum(directive.kind in _CONDITIONAL for directive in directives))
        expressions = sum(len(each.text) // 4 for each in directives if each.kind in ("if", "elif"))
        self._weights[name] = 1 + len(directives) + expressions

    def _is_guard(self, name: str, index: int) -> bool:
        """True if a directive asks if its file was included before: a ``#define`` of the same name follows it.

        If this macro has a value, it can also be a default: the group of a guard contains all other text of the file.
        """
        if (name, index) not in self._guards:
            directives = self._directives[name]
            asked = _asked(directives[index])
            following = (each for each in directives[index + 1 : index + 3] if each.kind != "pragma")
            after = next(following, None) if asked is not None else None
            words = after.text.split() if after is not None and after.kind == "define" else []
            whole = words == [asked] or (words == [asked, "1"] and _is_all(self._read(name), directives, index, after))
            self._guards[name, index] = whole
        return self._guards[name, index]


def _is_all(file: SourceFile, directives: list[_Directive], index: int, define: _Directive | None) -> bool:
    """True if the group that the directive at ``index`` begins is the whole file, and has text after ``define``."""
    text, depth = file.without_comments, 0
    if define is None or any(each.kind != "pragma" for each in directives[:index]):
        return False
    for each in directives[index:]:
        depth += each.kind in ("if", "ifdef", "ifndef")
        depth -= each.kind == "endif"
        if depth == 1 and each.kind in ("else", "elif"):
            return False
        if depth == 0:
            before = text[directives[index - 1].end if index else 0 : directives[index].start]
            return not before.strip() and not text[each.end :].strip() and bool(text[define.end : each.start].strip())
    return False


_CONDITIONAL = ("if", "ifdef", "ifndef", "elif", "else", "endif")


def _of_file(file: SourceFile) -> list[_Directive]:
    included = list(includes(file))
    starts = [include.start for include in included]
    found = []
    for match in _DIRECTIVE.finditer(file.without_comments):
        start, end = match.span()
        include = None
        if match[1] == "include":
            index = bisect_left(starts, start)
            if index == len(starts) or starts[index] >= end:
                continue
            include = included[index]
        elif match[1] == "pragma" and match[2].split() != ["once"]:
            continue
        found.append(_Directive(match[1], match[2], start, end, include))
    return found


def _conditional(directive: _Directive, groups: list[_Group], active: str, table: DefinedMacros, guard: bool) -> None:
    """Opens, changes or closes a group.  An ``#else`` or ``#endif`` without an ``#if`` is ignored."""
    kind = directive.kind
    if kind in ("if", "ifdef", "ifndef"):
        condition = NO if active == NO else _condition(directive, table, guard)
        groups.append(_Group(active, condition, condition))
    elif not groups:
        return
    elif kind == "endif":
        groups.pop()
    else:
        group = groups[-1]
        rest = inverse(group.before)
        open_ = kind == "else" or both(group.around, rest) == NO
        group.now = rest if open_ else both(rest, _condition(directive, table, False))
        group.before = either(group.before, group.now)


def _asked(directive: _Directive) -> str | None:
    """The macro X of ``#ifndef X``, ``#if !defined X`` or ``#if !defined(X)``."""
    if directive.kind == "ifndef":
        match = _NAME.match(directive.text)
        return match[1] if match is not None else None
    match = _NOT_DEFINED.fullmatch(directive.text) if directive.kind == "if" else None
    return (match[1] or match[2]) if match is not None else None


def _condition(directive: _Directive, table: DefinedMacros, guard: bool) -> str:
    asked = _asked(directive)
    if guard and asked is not None and table.guards(asked):
        return YES
    if directive.kind in ("if", "elif"):
        return condition_of(directive.text, table)
    match = _NAME.match(directive.text)
    if match is None:
        return OPEN
    when = table.when(match[1])
    if directive.kind == "ifdef":
        return when
    return inverse(when)


def _change(directive: _Directive, table: DefinedMacros, condition: str) -> None:
    """Applies a ``#define`` or ``#undef``."""
    match = _NAME.match(directive.text)
    if match is None:
        return
    if directive.kind == "undef":
        table.undefine(match[1], condition)
        return
    value = directive.text[match.end() :]
    table.define(match[1], None if value[:1] == "(" else value.strip(), condition)


def deciding_macros(line: str, wanted: str) -> list[str]:
    """The macros of which each alone, defined as 1, makes the condition in ``line`` :data:`YES` or :data:`NO`.

    ``line`` is an ``#if``, ``#ifdef``, ``#ifndef`` or ``#elif``.  Empty if the condition has this value without them.
    """
    match = _DIRECTIVE.match(line)
    if match is None or match[1] not in ("if", "ifdef", "ifndef", "elif"):
        return []
    directive = _Directive(match[1], match[2], 0, 0)
    if _condition(directive, DefinedMacros({}), False) == wanted:
        return []
    names = dict.fromkeys(name for name in re.findall(r"[A-Za-z_]\w*", match[2], re.ASCII) if name != "defined")
    return [name for name in names if _condition(directive, DefinedMacros({name: "1"}), False) == wanted]


def blank(parts: Iterable[ConditionalSection]) -> tuple[tuple[int, int], ...]:
    """The offsets of the parts that no compiler sees."""
    return tuple((part.start, part.end) for part in parts if part.condition == NO)


def condition_at(parts: Iterable[ConditionalSection], offset: int) -> str:
    """The condition under which the text at ``offset`` of a file with these ``parts`` is compiled."""
    return next((part.condition for part in parts if part.start <= offset < part.end), YES)
