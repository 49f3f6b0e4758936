# SPDX-License-Identifier: Apache-2.0
"""Positions of calls of EPG in a CMakeLists.txt, for messages about arguments that CMake has passed to EPG."""

from __future__ import annotations

import re
from pathlib import Path

from epg.generator.source import Span


def caller_span(file: str, name: str) -> Span:
    """The position of the call that makes the target ``name``; the file as a whole if it cannot be found."""
    word = rf"({re.escape(name)})\b"
    call = _find(file, rf"epg_add_(?:target|model)\s*\(\s*{word}")
    return call or _find(file, rf"epg_add_system\s*\([^)]*\bTARGETS\b[^)]*?\b{word}") or Span(file)


def setting_span(file: str | None, name: str, setting: str) -> Span:
    """The position of a setting: its argument in the CMakeLists.txt ``file``, or the command line if that is None."""
    if file is None:
        return Span.of_argument(setting)
    key, _, value = setting.partition("=")
    pattern = re.escape(setting)
    if key in ("node", "namespace"):
        pattern = rf'{key.upper()}\s+"?({re.escape(value)})'
    call = rf"epg_add_target\s*\(\s*{re.escape(name)}\b[^)]*?"
    return _find(file, rf"{call}({pattern})") or _find(file, rf"{call}\b()") or Span(file, text=setting)


def _find(file: str, pattern: str) -> Span | None:
    try:
        text = Path(file).read_text(encoding="utf-8", errors="replace")
    except OSError:
        return None
    match = re.search(pattern, text)
    if not match:
        return None
    group = match.lastindex or 0
    start = match.start(group)
    line = text.count("\n", 0, start) + 1
    column = start - (text.rfind("\n", 0, start) + 1) + 1
    return Span(file, line, column, column + max(1, match.end(group) - start))
