# SPDX-License-Identifier: Apache-2.0
"""Explains frequent mistakes in YAML: ``key value``, a tab, wrong indentation, a comment with ``//``.

A parser reports the position at which it could not continue, often a line too late, and in terms of its grammar.
:func:`find_mistake` reads the lines as a person does.  It is called only for text that the parser has refused.
Therefore it does not need to know rare forms of YAML: if it finds no mistake, the parser's own message is used.

>>> find_mistake("version: 1\\ntarget host\\nnode: a", 3)
Mistake(line=2, column=1, end=12, message="'target host' has no ':'", hint="write 'target: host'")
"""

from __future__ import annotations

import itertools
import re
from collections import Counter

from epg.generator.correction import correction, short
from epg.generator.dataclass import dataclass

LINE_END = re.compile("\r\n|\r|\n|\x85|\u2028|\u2029")
_ENTRY = r"""(?P<key>"(?:[^"\\]|\\.)*"|'[^']*'|[^\s'"{\[#](?:(?! \#).)*?)\s*:(?:\s+(?P<value>.*)|$)"""
_WITHOUT_COLON = r"(?P<key>[A-Za-z_][\w.]*)(?P<between>\s*=\s*|\s*:|\s+|$)(?P<value>.*)"
_COMMENT = re.compile(r"(?:^|(?<=\s))(?://+|/\*)")
_LONGEST = 1000  # A longer line was not written by a person, and its search would take too much time.
_QUOTES = "\"'"
_CLOSING = {"{": "}", "[": "]", '"': '"', "'": "'"}
_ESCAPES = {'"': "\\", "'": "''"}
"""For each quote, the begin of two characters that do not end a text in such quotes."""
_WHAT_OPENS_TEXT = "{[,:"


@dataclass(frozen=True)
class Mistake:
    """A mistake on one line.  Lines and columns count from 1; ``end`` is one past the last column."""

    line: int
    column: int
    end: int
    message: str
    hint: str


def missing_colon(text: str) -> tuple[str, str] | None:
    """Message and hint for ``key value``, ``key = value`` and ``key:value``, or None for other text."""
    match = re.fullmatch(_WITHOUT_COLON, text.strip())
    if match is None or (match["between"] == ":" and match["value"].startswith(("/", ":"))):
        return None
    hint = correction(text.strip(), f"{match['key']}: {match['value']}".rstrip(), "write '{}'")
    if "=" in match["between"]:
        return f"'{short(text)}' has '=' instead of ':'", hint
    if ":" in match["between"]:
        return f"'{short(text)}' has no space after ':'", hint
    return f"'{short(text)}' has no ':'", hint


def text_with_comma(line: str) -> str | None:
    """The sentence without quotes and with a comma that ``line`` begins with, up to a bracket; None for other text.

    A value of several words is a sentence, for which quotes were meant.  A value of one word, or one that begins with a
    digit, has a next key after its comma.

    >>> text_with_comma("level 1 of it, in F}")
    'level 1 of it, in F'
    """
    match = re.match(r"([A-Za-z][^\s,:]*\s[^,:]*,[^:]*?)\s*}", re.split(r"[\"'\\\[\]{]|\s#", line)[0])
    return match[1] if match else None


def foreign_comment(text: str) -> tuple[int, str, str] | None:
    """A comment in one line that begins with ``//`` or ``/*``: its index, message and hint; None without one."""
    match = _COMMENT.search(text)
    if match is None:
        return None
    written = text[match.start() :].rstrip()
    comment = text[match.end() :].strip().removesuffix("*/").rstrip()
    hint = correction(written, f"# {comment}", "write '{}'")
    of_several_lines = match[0] == "/*" and not written.endswith("*/")
    message = f"'{match[0]}' does not begin a comment in YAML"
    return match.start(), message, str(hint) if of_several_lines else hint


def find_mistake(text: str, last: int) -> Mistake | None:
    """The first mistake in ``text``, which the parser has refused at line number ``last``.

    None if this module does not know the mistake.
    """
    return _Reader(LINE_END.split(text)).read(last)


@dataclass
class _Level:
    """Successive entries with the same indentation."""

    indent: int
    line: int  # the line of the first entry
    kind: str  # "map", "list" or "text" (lines without ':', which can be a value of several lines)
    count: int = 0
    wants: bool = False  # True if the last entry has no value yet: then deeper lines can follow


class _Reader:
    """Reads a text line by line, and stops at the first mistake.

    It keeps the levels of indentation that are open, and the brackets and quotes that are open.
    """

    def __init__(self, lines: list[str]) -> None:
        self.lines = lines
        self.levels: list[_Level] = []
        self.open: list[tuple[str, int, int]] = []  # open brackets and quotes: character, line, column from 0
        self.block: int | None = None  # the indentation of the key whose value is a block of text

    def read(self, last: int) -> Mistake | None:
        for number, line in enumerate(self.lines[:last], 1):
            content = line.lstrip(" \t")
            if self.open and len(line) <= _LONGEST:
                mistake = self._unclosed(number, line) or self._value(number, line, 0)
            elif not content or content.startswith("#") or self._is_text(line, content):
                continue
            elif len(line) > _LONGEST or content.startswith(("? ", "---", "...", "%")):
                return None
            else:
                self.block = None
                mistake = self._line(number, line, content)
            if mistake is not None:
                return mistake
        return self._never_closed(last) if self.open else None

    def _is_text(self, line: str, content: str) -> bool:
        """True if a line belongs to a block of text, or is the ``---`` that begins the document."""
        in_block = self.block is not None and len(line) - len(content) > self.block
        return in_block or (content.startswith("---") and not self.levels)

    def _line(self, number: int, line: str, content: str) -> Mistake | None:
        """Reads a line outside of brackets, quotes and blocks of text; ``content`` is the line without indentation."""
        indent = len(line) - len(content)
        if "\t" in line[:indent]:
            column = line.index("\t") + 1
            hint = "write spaces instead: YAML does not allow tabs here"
            return Mistake(number, column, indent + 1, "this line is indented with a tab", hint)
        comment = foreign_comment(content)
        if comment and comment[0] == 0:
            return Mistake(number, indent + 1, len(line) + 1, *comment[1:])
        mistake = self._place(number, indent, content)
        if mistake is not None or not self.levels:
            return mistake
        indent, content = self._after_dashes(number, indent, content)
        entry = re.match(_ENTRY, content)
        if entry is None or self.levels[-1].kind != "map":
            return self._value(number, line, indent)
        value = entry["value"] or ""
        self.levels[-1].wants = not value or re.match(r"#|[&!]\S*\s*$", value) is not None
        if value[:1] in ("|", ">"):
            self.block = self.levels[-1].indent
            return None
        return self._value(number, line, indent + entry.start("value")) if value else None

    def _after_dashes(self, number: int, indent: int, content: str) -> tuple[int, str]:
        """Opens the levels of the entries of lists that begin on a line.  Returns the column and text behind them."""
        while content == "-" or content.startswith("- "):
            self.levels[-1].wants = content == "-"
            rest = content[1:].lstrip(" ")
            indent += len(content) - len(rest)
            content = rest
            if content.startswith("- ") or re.match(_ENTRY, content):
                kind = "list" if content.startswith("- ") else "map"
                self.levels.append(_Level(indent, number, kind))
        return indent, content

    def _place(self, number: int, indent: int, content: str) -> Mistake | None:
        """Finds the level of a line by its indentation, or begins a new one.  Returns a mistake, if there is one."""
        kind = "list" if re.match(r"-(\s|$)", content) else "map" if re.match(_ENTRY, content) else "text"
        left: list[_Level] = []
        while self.levels and indent < self.levels[-1].indent:
            left.append(self.levels.pop())
        top = self.levels[-1] if self.levels else None
        if top is None:
            if left:
                return self._indented(left[-1].line, f"write no space before it, as in line {number}")
        elif indent > top.indent:
            return self._deeper(number, indent, kind, left)
        elif not (kind == "list" and top.kind == "map" and top.wants):  # A list can be as deep as its key.
            return self._next_entry(number, kind)
        self.levels.append(_Level(indent, number, kind, 1))
        return None

    def _deeper(self, number: int, indent: int, kind: str, left: list[_Level]) -> Mistake | None:
        """Begins a level below the last one, after the deeper ones that the line has ``left``.  Returns a mistake."""
        top = self.levels[-1]
        if left and not (top.kind == "list" and top.wants):
            return self._between(number, indent, top, left[-1])
        if top.kind == "text" and kind == "map":
            return self._without_colon(top.line)
        if top.wants:
            self.levels.append(_Level(indent, number, kind, 1))
        elif kind == "map":
            return self._indented(number, _write_spaces(top.indent, top.line))
        return None

    def _next_entry(self, number: int, kind: str) -> Mistake | None:
        """Adds a line to the last level, which has the same indentation.  Returns a mistake, if there is one."""
        top = self.levels[-1]
        if kind == "map" and top.kind == "list" and len(self.levels) > 1 and self.levels[-2].indent == top.indent:
            self.levels.pop()
            top = self.levels[-1]
        if kind == "map" and top.kind == "text":
            return self._without_colon(top.line)
        if kind == "text" and top.kind == "map":
            return self._without_colon(number)
        top.count += 1
        return None

    def _between(self, number: int, indent: int, above: _Level, left: _Level) -> Mistake:
        """The mistake of a line that is indented more than ``above`` but less than ``left``.

        Either this line or the first line of ``left`` is wrong.  The first line of ``left`` is, if it is the only line
        of its level, and other lines, or the usual step of the file, agree with this line.
        """
        alike = 0
        for line in self.lines[number - 1 :]:
            content = line.lstrip(" ")
            if content and not content.startswith("#"):
                if len(line) - len(content) <= above.indent:
                    break
                alike += len(line) - len(content) == indent
        step = self._usual_step()
        usual = indent - above.indent == step != left.indent - above.indent
        if left.count == 1 and (alike > 1 or usual):
            return self._indented(left.line, _write_spaces(indent, number))
        return self._indented(number, _write_spaces(left.indent, left.line))

    def _usual_step(self) -> int:
        indents = [len(line) - len(line.lstrip(" ")) for line in self.lines if line.strip()]
        steps = Counter(b - a for a, b in itertools.pairwise(indents) if b > a)
        return steps.most_common(1)[0][0] if steps else 2

    def _indented(self, number: int, hint: str) -> Mistake:
        line = self.lines[number - 1]
        content = line.lstrip(" ")
        indent = len(line) - len(content)
        entry = re.match(_ENTRY, content)
        end = indent + (entry.end("key") if entry else len(content)) + 1
        spaces = "1 space" if indent == 1 else f"{indent} spaces" if indent else "no space"
        return Mistake(number, indent + 1, end, f"wrong indentation: {spaces} before this line", hint)

    def _without_colon(self, number: int) -> Mistake | None:
        line = self.lines[number - 1]
        content = re.sub(r"\s#.*", "", line.strip()).rstrip()
        mistake = missing_colon(content)
        column = len(line) - len(line.lstrip()) + 1
        return Mistake(number, column, column + len(content), *mistake) if mistake else None

    def _value(self, number: int, line: str, start: int) -> Mistake | None:
        """Reads a line from ``start``: a value begins there, or continues if brackets or quotes are open."""
        if not self.open:
            if line[start : start + 1] not in ("{", "[", '"', "'"):
                return self._plain(number, line, start)
            self.open.append((line[start], number, start))
            start += 1
        end = self._close(number, line, start)
        rest = line[end:].lstrip() if end is not None else ""
        if end is None or not rest or rest.startswith("#"):
            return None
        column = len(line) - len(rest) + 1
        comment = foreign_comment(rest)
        if comment and comment[0] == 0:
            return Mistake(number, column, len(line) + 1, *comment[1:])
        if rest.startswith(":"):
            return None
        return Mistake(number, column, len(line) + 1, f"'{short(rest)}' is after the end of the value", "remove it")

    def _plain(self, number: int, line: str, start: int) -> Mistake | None:
        """Reads a value without quotes and brackets, which ends with its line."""
        value = re.sub(r"(^|\s)#.*", "", line[start:]).rstrip()
        comment = foreign_comment(value)
        if comment:
            return Mistake(number, start + comment[0] + 1, start + len(value) + 1, *comment[1:])
        if value[:1] in tuple("@`%*&!") and value:
            message = f"a value cannot begin with '{value[0]}'"
            hint = _plain_hint(value)
            return Mistake(number, start + 1, start + len(value) + 1, message, hint)
        colon = re.search(r":(\s|$)", value)
        if colon and self.levels and self.levels[-1].kind == "map":
            column = start + colon.start() + 1
            return Mistake(
                number, column, column + 1, "this line has a second ':'", "put the text in quotes, or begin a new line"
            )
        return None

    def _close(self, number: int, line: str, start: int) -> int | None:
        """The index in the line at which the open value ends, or None if it continues in the next line."""
        at = start
        while at < len(line):
            character, opened = line[at], self.open[-1][0]
            if opened in _QUOTES:
                if line.startswith(_ESCAPES[opened], at):
                    at += 1
                elif character == opened:
                    self.open.pop()
            elif character == "#" and line[at - 1 : at].strip() == "":
                return None
            elif character in "{[" or (character in _QUOTES and line[:at].rstrip()[-1:] in _WHAT_OPENS_TEXT):
                self.open.append((character, number, at))
            elif character == _CLOSING[opened]:
                self.open.pop()
            at += 1
            if not self.open:
                return at
        return None

    def _unclosed(self, number: int, line: str) -> Mistake | None:
        """The mistake of a bracket or quote that is still open when a key follows.

        The key must not be indented deeper than the line of the bracket: then it cannot be a part of its value.
        """
        _, opened, _ = self.open[0]
        first = self.lines[opened - 1]
        entry = re.match(_ENTRY, line.lstrip(" "))
        if entry is None or len(line) - len(line.lstrip(" ")) > len(first) - len(first.lstrip(" ")):
            return None
        return self._open_mistake()

    def _never_closed(self, last: int) -> Mistake | None:
        """The mistake of a bracket or quote that is open at line ``last`` and is not closed in any later line."""
        for number, line in enumerate(self.lines[last:], last + 1):
            if len(line) > _LONGEST:
                return None
            mistake = self._unclosed(number, line)
            if mistake or self._close(number, line, 0) is not None:
                return mistake
        return self._open_mistake()

    def _open_mistake(self) -> Mistake:
        character, line, column = self.open[-1]
        message = f"this {'quote' if character in _QUOTES else 'bracket'} is not closed"
        return Mistake(line, column + 1, column + 2, message, f"write {_CLOSING[character]} where it ends")


def _plain_hint(value: str) -> str:
    """The hint for a value that begins with a character of YAML.

    Quotes are probably meant only if the character has no meaning in YAML: ``*`` and ``&`` are for aliases.
    """
    if re.fullmatch(r"`[^`]+`", value):
        return correction(value, value[1:-1], "write '{}', without '`'")
    hint = correction(value, f'"{value}"', "write it in quotes: {}")
    return hint if value[0] in "@%" and not set(value) & {'"', "\\"} else str(hint)


def _write_spaces(indent: int, line: int) -> str:
    spaces = "1 space" if indent == 1 else f"{indent} spaces" if indent else "no space"
    return f"write {spaces} before it, as in line {line}"
