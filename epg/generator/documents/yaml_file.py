# SPDX-License-Identifier: Apache-2.0
"""YAML 1.2 files as trees of :class:`~epg.generator.source.YamlNode`, each value with its position.

PyYAML delivers the events of the document, and this module builds the tree.  PyYAML's own constructors lack what EPG
needs: the rules of YAML 1.2 for scalars (``on`` is text, ``1e3`` a number), positions, an error for duplicate keys, a
limit of the depth that is checked before any recursion, and an error for anchors, aliases and tags.
"""

from __future__ import annotations

import re
from dataclasses import field, replace
from functools import cached_property
from pathlib import Path
from types import MappingProxyType
from typing import cast

import yaml

from epg.generator.correction import correction, short
from epg.generator.dataclass import dataclass
from epg.generator.diagnostics import Diagnostics, Note
from epg.generator.documents.text_file import NO_DRAFTS, Drafts, read_text
from epg.generator.documents.yaml_mistakes import (
    LINE_END,
    find_mistake,
    foreign_comment,
    missing_colon,
    text_with_comma,
)
from epg.generator.quantity import decimal_comma
from epg.generator.source import Scalar, Span, YamlNode

VERSION = 1
"""The version of all file formats.  The key is ``version`` in users' files, and ``api`` in folders of targets."""

MAX_DEPTH = 32
LOADER = getattr(yaml, "CSafeLoader", yaml.SafeLoader)
"""libyaml's parser if it is installed, else PyYAML's own.  They differ: PyYAML's refuses a tab before a comment."""

_NULL = {"", "~", "null", "Null", "NULL"}
_BOOL = {"true": True, "True": True, "TRUE": True, "false": False, "False": False, "FALSE": False}
_INT = re.compile(r"[-+]?[0-9]+")
_OCTAL = re.compile(r"0o[0-7]+")
_HEX = re.compile(r"0x[0-9a-fA-F]+")
_FLOAT = re.compile(r"[-+]?(\.[0-9]+|[0-9]+(\.[0-9]*)?)([eE][-+]?[0-9]+)?")
_SPECIAL = re.compile(r"([-+]?)\.(inf|Inf|INF)|\.(nan|NaN|NAN)")
_BEGINS_NUMBER = frozenset("+-.0123456789")
_MAX_DIGITS = 64


def load_yaml(
    path: Path, diagnostics: Diagnostics, wanted_by: Span | None = None, drafts: Drafts = NO_DRAFTS
) -> YamlNode | None:
    """The document in ``path``, or None after reporting mistakes."""
    text = read_text(path, diagnostics, wanted_by, drafts)
    return None if text is None else parse_yaml(text, str(path), diagnostics)


def newer_version(node: YamlNode, key: str, diagnostics: Diagnostics) -> bool:
    """True after reporting that the version of a file's format, at ``key``, is newer than this EPG."""
    stated = node.get(key)
    if stated is None or type(stated.value) is not int or stated.value <= VERSION:
        return False
    message = f"file format {stated.value} is newer than this EPG, which reads formats up to {VERSION}"
    diagnostics.error("newer-version", stated.span, message, hint="update EPG")
    return True


_HINTS = {
    "did not find expected '-' indicator": "begin each entry of a list with '-'; the entries of a map have no '-'",
}
"""Hints for problems that the YAML parser names."""

_TOO_DEEP = f"this is nested deeper than {MAX_DEPTH} levels", "is this the right file?"


def parse_yaml(text: str, file: str, diagnostics: Diagnostics) -> YamlNode | None:
    """The only document in ``text``, or None after reporting mistakes.  ``file`` is the file name in its positions.

    For a text that is not YAML, :func:`~epg.generator.documents.yaml_mistakes.find_mistake` explains the mistake if it
    can.
    """
    builder = _Builder(file, text, diagnostics)
    try:
        for event in yaml.parse(text, Loader=LOADER):
            if not builder.feed(event):
                return None
    except yaml.MarkedYAMLError as error:
        if builder.mistaken:
            return None
        _report_syntax(error, text, file, diagnostics)
        return None
    except (yaml.YAMLError, ValueError, RecursionError) as error:
        diagnostics.error("yaml-syntax", Span(file, 1, 1), f"YAML: {str(error).splitlines()[0]}")
        return None
    if builder.failed:
        return None
    return builder.root or YamlNode(None, Span(file, 1, 1))


def _report_syntax(error: yaml.MarkedYAMLError, text: str, file: str, diagnostics: Diagnostics) -> None:
    """Reports the mistake that made the parser refuse ``text``, as a person sees it, or else as the parser does."""
    mark = error.problem_mark or error.context_mark
    line, column = (mark.line + 1, mark.column + 1) if mark else (1, 1)
    mistake = find_mistake(text, line)
    if mistake is not None:
        span = Span(file, mistake.line, mistake.column, mistake.end)
        diagnostics.error("yaml-syntax", span, mistake.message, hint=mistake.hint)
        return
    problem = (error.problem or str(error)).replace("\n", " ")
    if problem == "exceeded maximum nesting depth":  # of PyYAML 6.0.4, which reads ahead
        diagnostics.error("yaml-depth", Span(file, line, column), _TOO_DEEP[0], hint=_TOO_DEEP[1])
        return
    notes = []
    if error.context and error.context_mark and error.context_mark is not mark:
        where = Span(file, error.context_mark.line + 1, error.context_mark.column + 1)
        notes.append(Note(str(error.context), where))
    hint = _HINTS.get(problem, "")
    diagnostics.error("yaml-syntax", Span(file, line, column), f"YAML: {problem}", hint=hint, notes=notes)


@dataclass
class _Collection:
    """A mapping or sequence whose end has not been seen yet."""

    span: Span
    mapping: bool
    flow: bool
    children: list[YamlNode] = field(default_factory=list)
    entries: dict[str, YamlNode] = field(default_factory=dict)
    keys: dict[str, Span] = field(default_factory=dict)
    key: str | None = None
    key_mark: yaml.Mark | None = None  # the end of the key
    skip: bool = False  # True while the next value belongs to a refused key


class _Builder:
    """Builds the tree of one document from the events of PyYAML's parser.

    ``stack`` holds the collections that are open.  ``failed`` is True after an error: then the tree is not used.
    """

    def __init__(self, file: str, text: str, diagnostics: Diagnostics) -> None:
        self.file = file
        self.text = text
        self.diagnostics = diagnostics
        self.stack: list[_Collection] = []
        self.root: YamlNode | None = None
        self.documents = 0
        self.failed = False
        self.mistaken = False  # True after an error that may also be the reason for a later error of the parser

    @cached_property
    def lines(self) -> list[str]:
        return LINE_END.split(self.text)

    def feed(self, event: yaml.Event) -> bool:
        """Adds one event to the tree.  False if the rest of the document cannot be read after an error."""
        if isinstance(event, yaml.AliasEvent) or (isinstance(event, yaml.NodeEvent) and event.anchor):
            return self._refuse(
                event, "yaml-alias", "anchors and aliases are not supported", "write the value again, or use 'extends'"
            )
        if isinstance(event, (yaml.ScalarEvent, yaml.CollectionStartEvent)) and event.tag not in (None, "!"):
            return self._refuse(event, "yaml-tag", f"tags such as '{event.tag}' are not supported", "remove the tag")
        if isinstance(event, yaml.ScalarEvent):
            self._scalar(event)
        elif isinstance(event, yaml.CollectionStartEvent):
            return self._begin(event)
        elif isinstance(event, (yaml.MappingEndEvent, yaml.SequenceEndEvent)):
            done = self.stack.pop()
            if done.mapping:
                self._add(YamlNode(MappingProxyType(done.entries), done.span, MappingProxyType(done.keys)))
            else:
                self._add(YamlNode(tuple(done.children), done.span))
        elif isinstance(event, yaml.DocumentStartEvent):
            self.documents += 1
            if self.documents > 1:
                return self._refuse(
                    event, "yaml-documents", "the file has a second document", "keep one document and remove '---'"
                )
        return True

    def _begin(self, event: yaml.CollectionStartEvent) -> bool:
        """Opens a map or a list.  False after an error."""
        if len(self.stack) >= MAX_DEPTH:
            return self._refuse(event, "yaml-depth", *_TOO_DEEP)
        if self.stack and self.stack[-1].mapping and self.stack[-1].key is None:
            message = "a key must be a word, not a list or a map"
            return self._refuse(event, "yaml-key", message, "put it in quotes if it is meant as text")
        mapping = isinstance(event, yaml.MappingStartEvent)
        self.stack.append(_Collection(self._span(event), mapping, bool(event.flow_style)))
        return True

    def _scalar(self, event: yaml.ScalarEvent) -> None:
        """Adds a scalar as the next key of the open map, or as a value."""
        span = self._span(event)
        top = self.stack[-1] if self.stack else None
        if not event.style and (self._foreign_comment(event) or self._key_without_colon(event, top)):
            self.failed = self.mistaken = True
        if top is not None and top.mapping and top.key is None:
            top.key, top.key_mark = event.value, _marks(event)[1]
            if event.value in top.keys:
                top.skip = self.failed = True
                first = Note("first written here", top.keys[event.value])
                hint = "remove one of the two"
                self.diagnostics.error(
                    "duplicate-key", span, f"key '{event.value}' is set twice", hint=hint, notes=[first]
                )
            else:
                top.keys[event.value] = span
            return
        value: Scalar = event.value
        if event.implicit[0] and not event.style:
            value = self._plain_value(event.value, span)
        self._add(YamlNode(value, span))

    def _foreign_comment(self, event: yaml.ScalarEvent) -> bool:
        """Reports a comment that begins with ``//`` or ``/*``, which YAML reads as text; True if there is one."""
        if "/" not in event.value:
            return False
        start, end = _marks(event)
        for number, line in enumerate(LINE_END.split(self.text[start.index : end.index])):
            comment = foreign_comment(line)
            if comment is not None:
                first = start.column + 1 if number == 0 else 1
                span = Span(self.file, start.line + 1 + number, first + comment[0], first + len(line))
                # A comment goes to the end of its line, so it must not hide a bracket behind this text.
                alone = not self.lines[span.line - 1][span.end - 1 :].strip()
                self.diagnostics.error("yaml-syntax", span, comment[1], hint=comment[2] if alone else str(comment[2]))
                return True
        return False

    def _key_without_colon(self, event: yaml.ScalarEvent, top: _Collection | None) -> bool:
        """Reports mistakes in braces, in which YAML sees a key without a value; True if there is one of them.

        In ``{period 1 ms}`` all of the text is a key.  In ``{period: 1,5 ms}`` the decimal comma begins a key ``5 ms``,
        and in ``{description: a level, in F}`` the comma begins a key ``in F``.
        """
        start, end = _marks(event)
        if event.value or top is None or not top.flow or top.key is None or top.key_mark is None or top.skip:
            return False
        if start.index != top.key_mark.index or self.text[end.index - 1] == ":":
            return False
        key = top.keys[top.key]
        before = next(reversed(top.entries.values()), None)
        if before is not None and before.span.line == key.line:
            whole = replace(before.span, end=key.end)
            number = self.lines[key.line - 1][whole.column - 1 : whole.end - 1]
            hint = decimal_comma(number)
            if hint:
                self.diagnostics.error("yaml-syntax", whole, f"'{number}' is written with a decimal comma", hint=hint)
                return True
            text = text_with_comma(self.lines[key.line - 1][whole.column - 1 :])
            if text is not None:
                whole = replace(whole, end=whole.column + len(text))
                message = f"'{short(text)}' has a comma, which ends a text in braces"
                hint = correction(text, f'"{text}"', "write it in quotes: {}")
                self.diagnostics.error("yaml-syntax", whole, message, hint=hint)
                return True
        mistake = missing_colon(top.key)
        if mistake is not None:
            self.diagnostics.error("yaml-syntax", key, mistake[0], hint=mistake[1])
        return mistake is not None

    def _plain_value(self, text: str, span: Span) -> Scalar:
        """The value of a scalar without quotes, by the core schema of YAML 1.2 (section 10.3).

        Reports decimal numbers that begin with a zero, because YAML 1.1 reads them as octal.
        """
        if text in _NULL:
            return None
        if text in _BOOL:
            return _BOOL[text]
        if text[0] not in _BEGINS_NUMBER or len(text) > _MAX_DIGITS:
            return text
        if _INT.fullmatch(text):
            self._check_octal(text, span)
            return int(text)
        if _OCTAL.fullmatch(text):
            return int(text[2:], 8)
        if _HEX.fullmatch(text):
            return int(text[2:], 16)
        if _FLOAT.fullmatch(text):
            return float(text)
        special = _SPECIAL.fullmatch(text)
        if special:
            return float("nan") if special[3] else float(f"{special[1]}inf")
        return text

    def _check_octal(self, text: str, span: Span) -> None:
        """Reports a decimal number that begins with a zero."""
        digits = text.lstrip("+-")
        if len(digits) > 1 and digits[0] == "0":
            octal = f", or 0o{digits.lstrip('0')}" if re.fullmatch("[0-7]+", digits) and digits.strip("0") else ""
            hint = f"write {int(text)}{octal}" if octal else correction(text, str(int(text)), "write {}")
            message = f"'{text}' is octal in YAML 1.1 and decimal in YAML 1.2"
            self.failed = True
            self.diagnostics.error("yaml-1.1-trap", span, message, hint=hint)

    def _add(self, node: YamlNode) -> None:
        if not self.stack:
            self.root = node
            return
        top = self.stack[-1]
        if not top.mapping:
            top.children.append(node)
            return
        assert top.key is not None
        if not top.skip:
            top.entries[top.key] = node
        top.key, top.skip = None, False

    def _span(self, event: yaml.Event) -> Span:
        start, end = _marks(event)
        last = end.column + 1 if end.line == start.line else start.column + 2
        if isinstance(event, yaml.CollectionStartEvent):
            last = start.column + 2
        return Span(self.file, start.line + 1, start.column + 1, max(last, start.column + 2))

    def _refuse(self, event: yaml.Event, id: str, message: str, hint: str) -> bool:
        self.diagnostics.error(id, self._span(event), message, hint=hint)
        self.failed = True
        return False


def _marks(event: yaml.Event) -> tuple[yaml.Mark, yaml.Mark]:
    """The begin and the end of an event in the text.  Every event of the parser has both."""
    return cast("tuple[yaml.Mark, yaml.Mark]", (event.start_mark, event.end_mark))
