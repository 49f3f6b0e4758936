# SPDX-License-Identifier: Apache-2.0
"""Makes C identifiers from the names in a model.

>>> to_identifier("PID1\\\\kp"), to_identifier("p.e"), to_identifier("double"), to_identifier("2nd stage")
('PID1_kp', 'p_e', 'double_', '_2nd_stage')
"""

from __future__ import annotations

import re
from collections.abc import Iterable

from epg.generator.documents.source_file import RESERVED


def words(text: str) -> frozenset[str]:
    """The set of words in ``text``: a readable way to write a large set."""
    return frozenset(text.split())


_LIMITS = re.compile(
    r"(?:U?INT(?:_LEAST|_FAST)?(?:8|16|32|64|PTR|MAX)|PTRDIFF|SIZE|SIG_ATOMIC|WCHAR|WINT|(?:S?CHAR|U?SHRT|U?INT|U?LONG|U?LLONG))"
    r"_(?:MAX|MIN|WIDTH)|UCHAR_MAX|CHAR_BIT"
)
"""Macros of <stdint.h> and <limits.h>, which generated files or files of the user include."""


def is_reserved(name: str) -> bool:
    """True if ``name`` is a keyword or a macro, which cannot name a member of a struct in generated code."""
    return name in RESERVED or _LIMITS.fullmatch(name) is not None or name.startswith("EPG_")


def to_identifier(name: str) -> str:
    """The C identifier for a name.

    Characters that C does not allow become ``_``.  A reserved word gets ``_`` at its end.  A name that is reserved for
    the compiler, or that begins with ``EPG_``, gets ``x`` at its start.
    """
    identifier = re.sub(r"_+", "_", re.sub(r"[^A-Za-z0-9_]", "_", name)) if not is_identifier(name) else name
    if not identifier or identifier[0].isdigit():
        identifier = f"_{identifier}"
    if re.match(r"__|_[A-Z]|EPG_", identifier):  # the compiler reserves the first two; EPG's headers define EPG_ macros
        identifier = "x" + identifier
    return f"{identifier}_" if is_reserved(identifier) else identifier


def unique_titles(names: Iterable[str]) -> list[str]:
    """The names, in order.  If several are equal, all but the first one get a number: ``kp``, ``kp#2``."""
    counts: dict[str, int] = {}
    result = []
    for name in names:
        counts[name] = counts.get(name, 0) + 1
        result.append(name if counts[name] == 1 else f"{name}#{counts[name]}")
    return result


def unique_identifiers(names: Iterable[str]) -> list[str]:
    """The identifiers for ``names``, in order.  If several are equal, all but the first one get a number."""
    used: set[str] = set()
    counts: dict[str, int] = {}
    result: list[str] = []
    for name in names:
        identifier = first = to_identifier(name)
        while identifier in used:
            counts[first] = counts.get(first, 1) + 1
            identifier = f"{first}_{counts[first]}"
        used.add(identifier)
        result.append(identifier)
    return result


def is_identifier(name: str) -> bool:
    """True if C allows these characters in a name.  A reserved word is one, too: see :func:`is_reserved`."""
    return re.fullmatch(r"[A-Za-z_][A-Za-z0-9_]*", name) is not None
