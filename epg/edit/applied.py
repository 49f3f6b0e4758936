# SPDX-License-Identifier: Apache-2.0
"""Finds and makes the edits that diagnostics propose.

>>> edit = Edit(Span("robot.tcf", 2, 11, 16), "perid", "period")
>>> print(apply_edit("version: 1\\ncontrol: {perid: 1 ms}   # fast\\n", edit), end="")
version: 1
control: {period: 1 ms}   # fast
"""

from __future__ import annotations

import re
from collections.abc import Callable

from epg.generator.correction import KeyValue, proposals_of
from epg.generator.data import is_own_target_file
from epg.generator.diagnostics import LINE_BREAK, Diagnostic, Edit
from epg.generator.source import Span

_NO_WORD = re.compile(r"[\s{}\[\],:]")


def line_of(text: str, number: int) -> str:
    """The line of ``text`` with this number, as YAML counts lines; empty if there is no such line."""
    lines = LINE_BREAK.split(text)
    return lines[number - 1] if 0 < number <= len(lines) else ""


def apply_edit(text: str, edit: Edit) -> str | None:
    """``text``, without its byte order mark, after the edit; None if the old text is not at its position any more."""
    starts = [0, *(match.end() for match in LINE_BREAK.finditer(text))]
    if not 0 < edit.span.line <= len(starts):
        return None
    start = starts[edit.span.line - 1]
    return edit.within(text, start) if edit.fits(text, start) else None


def edits_of(diagnostic: Diagnostic, text_of: Callable[[str], str | None]) -> list[Edit]:
    """The edits that the hint of a diagnostic proposes: none, one, or several of which the user chooses one.

    ``text_of`` gives the text of a file without its byte order mark, or None for a file that cannot be changed.
    """
    edits = []
    for hint in proposals_of(diagnostic.hint):
        edit: Edit | None
        if isinstance(hint, KeyValue):
            text = text_of(hint.file) if not is_own_target_file(hint.file) else None
            edit = _edit_of_key(hint, text) if text is not None else None
        else:
            span = diagnostic.span
            text = (text_of(span.file) if span.text is None else "") if span.line else None
            edit = diagnostic.edit(line_of(text, span.line), hint) if text is not None else None
        if edit is not None:
            edits.append(edit)
    return edits


def _edit_of_key(hint: KeyValue, text: str) -> Edit | None:
    from epg.edit.tcf import set_value  # few diagnostics propose such a change
    from epg.edit.yaml_edit import CannotEdit

    try:
        changed = set_value(text, hint.file, hint.path, hint.value, hint.order)
    except CannotEdit:
        return None
    return _edit_between(hint.file, text, changed, str(hint))


def _edit_between(file: str, before: str, after: str, sentence: str) -> Edit | None:
    """The edit that makes ``after`` of ``before``; None if they are equal.

    Whole lines are inserted at the end of the line above them.  Words and comments are replaced as a whole.
    """
    start = _common(before, after)
    common = _common(before[start:][::-1], after[start:][::-1])
    end, new = len(before) - common, after[start : len(after) - common]
    if start == end:
        start, new = _at_line_end(before, start, new)
        end = start
    else:
        while start > 0 and not _NO_WORD.match(before[start - 1]):
            start, new = start - 1, before[start - 1] + new
        stop = LINE_BREAK if "#" in before[start:end] else _NO_WORD
        while end < len(before) and not stop.match(before[end]):
            end, new = end + 1, new + before[end]
    old = before[start:end]
    if new == old:
        return None
    starts = [0, *(match.end() for match in LINE_BREAK.finditer(before, 0, start))]
    first, column = LINE_BREAK.split(old)[0], start - starts[-1] + 1
    span = Span(file, len(starts), column, column + len(first))
    return Edit(span, old, new, sentence, line_of(before, len(starts)))


def _common(one: str, other: str) -> int:
    """The number of characters with which both texts begin."""
    return next((i for i, pair in enumerate(zip(one, other)) if pair[0] != pair[1]), min(len(one), len(other)))


def _at_line_end(text: str, position: int, new: str) -> tuple[int, str]:
    """Another place of an insertion, and its text, with the same result.

    It is the end of a line or the begin of the text, if one of them is possible.
    """
    place, inserted = position, new
    while inserted and not (LINE_BREAK.match(inserted) and text[:place][-1:] + inserted[:1] != "\r\n"):
        if place == 0:
            break
        if text[place - 1] != inserted[-1]:
            return position, new
        place, inserted = place - 1, inserted[-1] + inserted[:-1]
    return place, inserted
