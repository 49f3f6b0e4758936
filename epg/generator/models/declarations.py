# SPDX-License-Identifier: Apache-2.0
"""Finds the functions, variables and classes that a header declares and that another file must define."""

from __future__ import annotations

import re
from collections.abc import Iterator

from epg.generator.models.c_code import KEYWORDS, CFile

_FUNCTION = re.compile(r"(?<![\w.>])([A-Za-z_]\w{0,255})\s{0,80}\(", re.ASCII)
_EXTERN = re.compile(r"\bextern\s[^;(){}]{0,300};")
_NAME = re.compile(r"([A-Za-z_]\w{0,255})\s{0,80}(?:\[[^\]]{0,300}\]\s{0,80}){0,8}(?=[,;])", re.ASCII)
_CLASS = re.compile(r"\bclass\s{1,80}([A-Za-z_]\w{0,255})\s{0,80}(?::(?!:)[^;{}]{0,500})?\{", re.ASCII)
_BRACE = re.compile(r"[{}]")
_FRIEND = re.compile(r"\bfriend\b[^;]{0,300};")
_METHOD = r"\([^();{}]{0,1000}\)\s{0,80}(?:const\s{0,80}|override\s{0,80}|noexcept\s{0,80}){0,3};"


def declared_names(code: CFile) -> set[str]:
    """The functions and ``extern`` variables that ``code`` declares outside bodies, and its :func:`open_classes`."""
    names = open_classes(code)
    for text in outside_bodies(code):
        text = _without_classes(text)
        names.update(match[1] for match in _FUNCTION.finditer(text))
        for statement in _EXTERN.finditer(text):
            names.update(match[1] for match in _NAME.finditer(statement[0]))
    return names - KEYWORDS


def open_classes(code: CFile) -> set[str]:
    """The classes with a method that another file must define: it has no body in the class and is not pure virtual."""
    text = code.file.code
    classes, at = set(), 0
    for match in _CLASS.finditer(text):
        if match.start() < at:  # a class inside the previous one, whose text was already searched
            continue
        at = end_of_block(text, match.end())
        if any(re.search(_METHOD, part) for part in _level(text[match.end() : at])):
            classes.add(match[1])
    return classes


def _without_classes(text: str) -> str:
    """``text`` without the text between the braces of classes, because methods are not functions."""
    parts, at = [], 0
    for match in _CLASS.finditer(text):
        if match.start() >= at:
            parts.append(text[at : match.end()])
            at = end_of_block(text, match.end())
    return "".join([*parts, text[at:]])


def end_of_block(text: str, start: int) -> int:
    """The offset of the brace that closes the block which opens just before ``start``; the end of ``text`` if none."""
    depth = 1
    for match in _BRACE.finditer(text, start):
        depth += 1 if match[0] == "{" else -1
        if depth == 0:
            return match.start()
    return len(text)


def _level(body: str) -> Iterator[str]:
    """The parts of the body of a class that are not in braces, without declarations of friends."""
    depth, at = 0, 0
    for match in _BRACE.finditer(body):
        if match[0] == "{":
            if depth == 0:
                yield _FRIEND.sub("", body[at : match.start()])
            depth += 1
        else:
            depth -= 1
            at = match.end()
    yield _FRIEND.sub("", body[at:])


def outside_bodies(code: CFile) -> Iterator[str]:
    """The parts of the code between the bodies of functions."""
    at = 0
    for function in code.functions:
        yield code.file.code[at : function.body_start]
        at = function.body_end
    yield code.file.code[at:]
