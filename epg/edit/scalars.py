# SPDX-License-Identifier: Apache-2.0
"""Scalars as YAML text that YAML 1.1 and YAML 1.2 read as the same value, in blocks and between ``{}`` and ``[]``.

>>> scalar_text("encoder_pan.reset"), scalar_text("on"), scalar_text("1/4"), scalar_text("010"), scalar_text("1 kHz")
('encoder_pan.reset', "'on'", '1/4', "'010'", '1 kHz')
"""

from __future__ import annotations

import json
import re

_WORD = re.compile(r"[A-Za-z_][A-Za-z0-9_.-]*")
_PATH = re.compile(r"(~|\.{1,2}|[A-Za-z0-9_-]*)(/[A-Za-z0-9_.-]+)+")
_QUANTITY = re.compile(r"[-+]?[0-9][0-9.]*(e[-+]?[0-9]+)? [A-Za-z]+(/[A-Za-z]+)?")
_RATIO = re.compile(r"[-+]?[0-9][0-9.]*/[-+]?[0-9.]+")
_PLAIN = (_WORD, _PATH, _QUANTITY, _RATIO)
# YAML 1.1 reads more words as booleans than YAML 1.2.
_NO_TEXT = frozenset(("true", "false", "null", "yes", "no", "on", "off", "y", "n"))


def scalar_text(value: object, style: str = "") -> str:
    """``value`` on one line.  ``style`` is the quote that a text had before; the text keeps it if possible."""
    if isinstance(value, bool):
        return "true" if value else "false"
    if value is None:
        return "null"
    if isinstance(value, (int, float)):
        return repr(value).replace("inf", ".inf").replace("nan", ".nan")
    text = str(value)
    if any(character != " " and not character.isprintable() for character in text) or style == '"':
        return _double_quoted(text)
    return text if _is_plain(text) and style != "'" else "'" + text.replace("'", "''") + "'"


def _is_plain(text: str) -> bool:
    """True if a text needs no quotes."""
    return text.casefold() not in _NO_TEXT and any(form.fullmatch(text) for form in _PLAIN)


def _double_quoted(text: str) -> str:
    # The escapes of JSON are valid in YAML, except pairs of surrogates.
    return '"' + "".join(_escaped(character) for character in text) + '"'


def _escaped(character: str) -> str:
    if character.isprintable():
        return json.dumps(character, ensure_ascii=False)[1:-1]
    return f"\\U{ord(character):08X}" if ord(character) > 0xFFFF else f"\\u{ord(character):04X}"
