# SPDX-License-Identifier: Apache-2.0
"""Source files of a model as text, with positions.

The code that 20-sim generates is ASCII, but its comments hold names of users and companies, units and names of ports,
and editors save files in many encodings.  Therefore text is decoded as UTF-8 and, if this fails, as Latin-1, which
accepts every byte.
"""

from __future__ import annotations

import bisect
import re
from collections.abc import Callable
from functools import cached_property
from itertools import accumulate
from pathlib import Path

from epg.generator.dataclass import dataclass
from epg.generator.diagnostics import Diagnostics
from epg.generator.documents.text_file import ANOTHER_FILE, too_large
from epg.generator.source import Span

MAX_BYTES = 16 << 20

# A string that is not closed ends with its line.  Otherwise the search would go back, which takes quadratic time.
_BLANKED = re.compile(
    r"""//(?:\\\r?\n|[^\n])*|/\*.*?(?:\*/|\Z)|"(?:\\.|[^"\\\n])*(?:"|(?=\n)|\\?\Z)|'(?:\\.|[^'\\\n])*(?:'|(?=\n)|\\?\Z)""",
    re.DOTALL,
)
STRING = re.compile(r'"((?:\\.|[^"\\\n])*)(?:"|\\?(?=\n|\Z))')
"""A string; one without a closing quote ends with its line."""
_DIRECTIVE = re.compile(r"^[ \t]*#(?:\\\r?\n|[^\n])*", re.MULTILINE)
_LONGEST_SHOWN = 1000


C11 = frozenset(
    """auto break case char const continue default do double else enum extern float for goto if inline int long register
    restrict return short signed sizeof static struct switch typedef union unsigned void volatile while""".split()
)
"""The keywords of C11."""
RESERVED = C11.union(
    """alignas alignof and and_eq asm bitand bitor bool catch char16_t char32_t char8_t class compl concept
    const_cast consteval constexpr constinit co_await co_return co_yield decltype delete dynamic_cast explicit export
    false friend mutable namespace new noexcept not not_eq nullptr operator or or_eq private protected public
    reinterpret_cast requires static_assert static_cast template this thread_local throw true try typeid typename
    using virtual wchar_t xor xor_eq NULL EOF errno stdin stdout stderr assert unix linux i386 INFINITY NAN HUGE_VAL
    RAND_MAX""".split()
)
"""Keywords of C11 and C++20, and macros of C libraries and compilers."""


@dataclass(frozen=True)
class SourceFile:
    """One file of C or C++.

    ``inside``: the file is in an archive.  Its positions hold the text of their line, because messages cannot read it.
    ``left_out``: the offsets of the parts that no compiler sees.
    """

    path: Path
    text: str
    inside: bool = False
    left_out: tuple[tuple[int, int], ...] = ()

    @cached_property
    def _plain(self) -> str:
        return _BLANKED.sub(_blank, self.text)

    def leaving_out(self, parts: tuple[tuple[int, int], ...]) -> SourceFile:
        """The same file without the ``parts``."""
        file = SourceFile(self.path, self.text, self.inside, parts)
        file.__dict__["_plain"] = self._plain  # the search for comments takes most of the time
        return file

    @cached_property
    def without_comments(self) -> str:
        """The text with comments, contents of strings and the parts ``left_out`` replaced by blanks.

        All offsets stay the same.
        """
        text = self._plain
        parts, at = [], 0
        for start, end in self.left_out:
            parts += [text[at:start], _blanks(text[start:end])]
            at = end
        return "".join([*parts, text[at:]])

    @cached_property
    def code(self) -> str:
        """As :attr:`without_comments`, with preprocessor directives replaced by blanks, too."""
        return _DIRECTIVE.sub(_blank, self.without_comments)

    @cached_property
    def _line_starts(self) -> list[int]:
        return [0, *accumulate(len(line) + 1 for line in self.text.split("\n")[:-1])]

    def span(self, start: int, end: int | None = None) -> Span:
        """The position of the text from offset ``start`` to ``end``, which must be on one line."""
        line = bisect.bisect_right(self._line_starts, start)
        column = start - self._line_starts[line - 1] + 1
        length = max(1, (end if end is not None else start + 1) - start)
        shown = None
        if self.inside:
            at = self._line_starts[line - 1]
            shown = self.text[at : at + _LONGEST_SHOWN].split("\n", 1)[0]
        return Span(str(self.path), line, column, column + length, shown)

    def word_span(self, start: int) -> Span:
        """The position of the word in the code that begins at offset ``start``."""
        word = re.compile(r"\w*").match(self.code, start)
        return self.span(start, word.end() if word and word[0] else start + 1)


def read_source(path: Path, diagnostics: Diagnostics, wanted_by: Span | None = None) -> SourceFile | None:
    """The file at ``path``, or None after reporting why it cannot be read."""
    text = read_any_text(path, diagnostics, wanted_by)
    return None if text is None else SourceFile(path, text)


def read_any_text(path: Path, diagnostics: Diagnostics, wanted_by: Span | None = None) -> str | None:
    """The text of ``path`` in UTF-8, UTF-16 or Latin-1, or None after reporting why it cannot be read."""
    whole = wanted_by or Span(str(path))
    data = read_bytes(path, lambda message, hint: diagnostics.error("model-unreadable", whole, message, hint=hint))
    if data is None:
        return None
    if b"\0" in data and not data.startswith((b"\xff\xfe", b"\xfe\xff")):
        message = f"'{path.name}' is not a text file"
        diagnostics.error("model-unreadable", whole, message, hint="export the model again")
        return None
    return decode(data)


def read_bytes(path: Path, report: Callable[[str, str], None]) -> bytes | None:
    """The bytes of a file of at most 16 MiB, or None after calling ``report`` with a message and a hint."""
    try:
        with path.open("rb") as file:
            data = file.read(MAX_BYTES + 1)
    except OSError as error:
        report(f"cannot read '{path.name}': {error.strerror or error}", "check the file's permissions")
        return None
    if len(data) > MAX_BYTES:
        report(too_large(path.name, MAX_BYTES), ANOTHER_FILE)
        return None
    return data


def is_includable(name: str) -> bool:
    """True if a name can be written in ``#include <...>``, where C has no escape sequences."""
    return bool(name) and name.isprintable() and re.search(r'[<>"\\]|//|/\*', name) is None


def decode(data: bytes) -> str:
    """The text of a file: UTF-16 with a byte order mark, UTF-8, or else Latin-1.  Line ends become ``\\n``."""
    if data.startswith((b"\xff\xfe", b"\xfe\xff")):
        text = data.decode("utf-16", "replace")
    else:
        try:
            text = data.decode("utf-8-sig")
        except UnicodeDecodeError:
            text = data.decode("latin-1")
    return text.replace("\r\n", "\n").replace("\r", "\n")


def _blank(match: re.Match[str]) -> str:
    matched = match[0]
    if matched[0] in "\"'" and len(matched) >= 2 and matched[-1] == matched[0]:
        return matched[0] + _blanks(matched[1:-1]) + matched[-1]
    return _blanks(matched)


def _blanks(text: str) -> str:
    return "\n".join(" " * len(line) for line in text.split("\n"))
