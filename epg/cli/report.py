# SPDX-License-Identifier: Apache-2.0
"""Diagnostics as text in the form that compilers use, or as JSON.

::

    jiwy.tcf:7:22: error: unknown key 'perid' [unknown-key]
        7 | control: {perid: 1 ms}
          |           ^~~~~
    hint: did you mean 'period'?
"""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Iterable, Sequence
from functools import cache
from pathlib import Path
from typing import Any

from epg.edit import applied
from epg.generator.diagnostics import Diagnostic, Diagnostics, Edit
from epg.generator.source import Span

_Reader = Callable[[str], Sequence[str]]


def _read_text(file: str) -> str | None:
    """The text of a file without its byte order mark; None if it cannot be read."""
    try:
        return Path(file).read_bytes().decode("utf-8-sig", "replace")
    except OSError:
        return None


def _read_lines(file: str) -> Sequence[str]:
    """The lines of a file; none if it cannot be read."""
    text = _read_text(file)
    return text.replace("\r\n", "\n").replace("\r", "\n").split("\n") if text is not None else ()


def format_diagnostics(diagnostics: Diagnostics) -> str:
    """The text of all diagnostics, sorted by file and line.  Errors and warnings are mixed."""
    ordered = sorted(diagnostics, key=lambda d: (d.span.file, d.span.line, d.span.column, d.id, d.message))
    lines_of = cache(_read_lines)
    return "".join(_format(diagnostic, lines_of) for diagnostic in ordered)


def edits_of(diagnostics: Iterable[Diagnostic]) -> list[list[Edit]]:
    """For each diagnostic the edits that its hint proposes: one, or several of which the user chooses one."""
    text_of = cache(_read_text)
    return [applied.edits_of(each, text_of) for each in diagnostics]


def diagnostics_data(diagnostics: Diagnostics) -> list[dict[str, Any]]:
    """All diagnostics as data for programs."""
    edits = edits_of(diagnostics)
    return [{**each.data(), "edits": [edit.data() for edit in proposed]} for each, proposed in zip(diagnostics, edits)]


def to_json(data: object) -> str:
    """The text of ``data`` as JSON, in the form that all commands print with ``--json``."""
    return json.dumps(data, indent=2, sort_keys=False, ensure_ascii=False) + "\n"


def shown_path(file: str) -> str:
    """The path to show to the user: relative to the current folder if the file is inside it, else unchanged.

    If EPG_ABSOLUTE_PATHS is set, absolute paths stay absolute, so that editors can open them.
    """
    path = Path(file)
    if path.is_absolute() and not os.environ.get("EPG_ABSOLUTE_PATHS"):
        try:
            return str(path.relative_to(Path.cwd()))
        except (ValueError, OSError):
            return file
    return file


def _format(d: Diagnostic, lines_of: _Reader) -> str:
    lines = [f"{_place(d.span)}: {d.severity}: {_printable(d.message)} [{d.id}]", *_excerpt(d.span, lines_of)]
    for note in d.notes:
        lines += [f"{_place(note.span)}: note: {_printable(note.message)}", *_excerpt(note.span, lines_of)]
    if d.hint:
        lines.append(f"hint: {_printable(d.hint)}")
    return "\n".join(lines) + "\n"


def _printable(text: str, instead: str = "") -> str:
    """Text of the user for one line of a terminal, without line ends, escape sequences and other control characters.

    Each of them is replaced by ``instead`` or, if that is empty, by its escape in Python: ``\\n``, ``\\x1b``.
    """
    if text.isprintable():
        return text
    return "".join(
        char if char.isprintable() or (instead and char == "\t") else instead or repr(char)[1:-1] for char in text
    )


def _place(span: Span) -> str:
    file = _printable(shown_path(span.file))
    if not span.line:
        return file
    return f"{file}:{span.line}:{span.column}" if span.column else f"{file}:{span.line}"


def _excerpt(span: Span, lines_of: _Reader) -> list[str]:
    """The line of the source that contains ``span``, and a line below with a caret under it."""
    if not span.line or not span.column:
        return []
    lines = lines_of(span.file) if span.text is None else (span.text,)
    number = span.line if span.text is None else 1
    if number > len(lines):
        return []
    text = _printable(lines[number - 1], "?").rstrip("\r\n")
    start, end = span.column - 1, max(span.end - 1, span.column)
    if start > len(text):
        return []
    first = 0
    if len(text) > 160:  # show only the part around the caret
        first = max(0, start - 60)
        text = text[first : first + 160]
    margin = f"{span.line:5d} | "
    blank = " " * 5 + " | "
    before = "".join("\t" if char == "\t" else " " for char in text[: start - first])
    length = max(1, min(end - start, len(text) - (start - first)))
    return [margin + text, blank + before + "^" + "~" * (length - 1)]
