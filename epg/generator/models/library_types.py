# SPDX-License-Identifier: Apache-2.0
"""Finds classes of the C++ library that targets cannot use, and names before a parenthesis that are not calls.

For example, a controller can read its parameters with ``std::ifstream file("gains.txt");``.  EPG reports the class.
It does not report the following ``std::getline`` and ``std::stod``, because they have the same cause.
"""

from __future__ import annotations

import re
from collections.abc import Iterator

from epg.generator.dataclass import dataclass
from epg.generator.models.c_code import KEYWORDS, CFile, Function
from epg.generator.models.identifiers import words

FILES = words("ifstream ofstream fstream wifstream wofstream wfstream basic_ifstream basic_ofstream filebuf")
HEAP = words(
    """
    string wstring stringstream istringstream ostringstream vector list deque map multimap set multiset unordered_map
    unordered_set stack queue priority_queue shared_ptr unique_ptr function any regex thread async future
    """
)
_TYPE = (
    rf"(?<![\w.>])(?P<std>std\s{{0,9}}::\s{{0,9}})?\b(?P<type>{'|'.join(sorted(FILES | HEAP))})\b"
    r"(?P<rest>\s{0,9}<[^;(){}]{0,200}>)?(?=\s{1,80}[A-Za-z_]\w{0,255}\s{0,80}[;({=,)]|\s{0,9}[({])"
)
_USING = r"\busing\s{1,80}namespace\s{1,80}std\s{0,80};"
_WORD = re.compile(r"\w+$")
_BEFORE_CALLS = words("return else do case throw new delete goto and or not xor co_return co_await sizeof")


@dataclass(frozen=True)
class LibraryObject:
    """A place where an object of a class of the library is made."""

    name: str
    start: int
    end: int


def library_uses(code: CFile, function: Function) -> Iterator[LibraryObject]:
    """The objects in the body of ``function`` whose classes use files or take memory from the heap."""
    if code.file.path.suffix.lower() == ".c":
        return
    text = code.file.code
    everywhere = re.search(_USING, text) is not None
    for match in re.compile(_TYPE, re.ASCII).finditer(text, function.body_start, function.body_end):
        if match["std"] or everywhere:
            yield LibraryObject(match["type"], match.start(), match.end("type"))


def is_declaration(code: CFile, start: int) -> bool:
    """True if the name at ``start``, before a parenthesis, declares an object: ``Gains gains("file");``."""
    before = code.file.code[max(0, start - 300) : start].rstrip(" \t")
    if before.endswith(">"):
        return re.search(r"\w\s{0,9}<[^<>;(){}]{0,200}>$", before) is not None
    word = _WORD.search(before[-256:])
    if word is None or word[0] in _BEFORE_CALLS or word[0][0].isdigit():
        return False
    return word[0] not in KEYWORDS or _is_type(word[0])


def is_of_std(code: CFile, start: int) -> bool:
    """True if ``std::`` is before the name at ``start``."""
    return re.search(r"\bstd\s{0,9}::\s{0,9}$", code.file.code[max(0, start - 30) : start]) is not None


def _is_type(word: str) -> bool:
    return word in ("auto", "bool", "char", "double", "float", "int", "long", "short", "signed", "unsigned", "const")
