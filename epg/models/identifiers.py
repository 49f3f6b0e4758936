# SPDX-License-Identifier: Apache-2.0
"""Makes C identifiers from the names in a model.

>>> to_identifier("PID1\\\\kp"), to_identifier("p.e"), to_identifier("double"), to_identifier("2nd stage")
('PID1_kp', 'p_e', 'double_', '_2nd_stage')
"""

from __future__ import annotations

import re
from collections.abc import Iterable


def words(text: str) -> frozenset[str]:
    """The set of words in ``text``: a readable way to write a large set."""
    return frozenset(text.split())


_C11 = words(
    """
    auto break case char const continue default do double else enum extern float for goto if inline int long
    register restrict return short signed sizeof static struct switch typedef union unsigned void volatile while
    """
)
_CPP = words(
    """
    alignas alignof and and_eq asm bitand bitor bool catch char16_t char32_t char8_t class compl concept
    const_cast consteval constexpr constinit co_await co_return co_yield decltype delete dynamic_cast explicit
    export false friend mutable namespace new noexcept not not_eq nullptr operator or or_eq private protected
    public reinterpret_cast requires static_assert static_cast template this thread_local throw true try typeid
    typename using virtual wchar_t xor xor_eq
    """
)
_MACROS = words("NULL EOF errno stdin stdout stderr assert unix linux i386 INFINITY NAN HUGE_VAL RAND_MAX")

RESERVED = _C11 | _CPP | _MACROS
"""Words that cannot name a member of a struct: keywords of C11 and C++20, macros of C libraries and compilers."""

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
    identifier = re.sub(r"_+", "_", re.sub(r"[^A-Za-z0-9_]", "_", name)) if not _is_identifier(name) else name
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


def _is_identifier(name: str) -> bool:
    return re.fullmatch(r"[A-Za-z_][A-Za-z0-9_]*", name) is not None
