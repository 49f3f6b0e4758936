# SPDX-License-Identifier: Apache-2.0
"""Checks the body of a request to a session.  No value of a body may reach a file without one of these checks."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

from epg.edit.bindings import WireEnd

_LONGEST = 1000
_MOST_ENDS = 64
_DEEPEST = 16

Body = Mapping[str, object]


class Refused(Exception):
    """An action that cannot be done.  ``message`` and ``hint`` are for the user; ``status`` is the HTTP status."""

    def __init__(self, message: str, hint: str = "", status: int = 400) -> None:
        super().__init__(message)
        self.message, self.hint, self.status = message, hint, status


def text(body: Body, key: str, default: str | None = None) -> str:
    """The text of ``key``, which must be one line of at most 1000 characters.  It is required without ``default``.

    Raises :class:`Refused`, as all functions of this module do.
    """
    value = body.get(key, default)
    if not isinstance(value, str) or len(value) > _LONGEST or not value.isprintable():
        raise Refused(f"'{key}' must be a text on one line")
    if not value and default is None:
        raise Refused(f"'{key}' is empty")
    return value


def number(body: Body, key: str, default: float | None = None) -> float:
    """The finite number at ``key``.  Raises Refused."""
    value = body.get(key, default)
    if isinstance(value, bool) or not isinstance(value, int | float) or not math.isfinite(value):
        raise Refused(f"'{key}' must be a number")
    return value


def boolean(body: Body, key: str) -> bool:
    value = body.get(key, False)
    if not isinstance(value, bool):
        raise Refused(f"'{key}' must be true or false")
    return value


def names(body: Body, key: str, default: Sequence[str]) -> list[str]:
    """The list of texts of ``key``, without duplicates; ``default`` if the body has no such key."""
    value = body.get(key, list(default))
    if not isinstance(value, list) or not all(isinstance(name, str) for name in value):
        raise Refused(f"'{key}' must be a list of names")
    return list(dict.fromkeys(value))


def bodies(body: Body, key: str) -> list[Body]:
    """The list of objects of ``key``, at most 64."""
    value = body.get(key)
    if not isinstance(value, list) or len(value) > _MOST_ENDS or not all(isinstance(each, Mapping) for each in value):
        raise Refused(f"'{key}' must be a list of objects")
    return value


def keys(value: object) -> tuple[str, ...]:
    """The keys of a path in a file: 1 to 16 texts."""
    if not isinstance(value, list) or not 0 < len(value) <= _DEEPEST:
        raise Refused("a path must be a list of keys")
    return tuple(text({"path": key}, "path") for key in value)


def ends(body: Body) -> tuple[WireEnd, ...]:
    """The ends of a wire, at most 64."""
    value = body.get("ends")
    if not isinstance(value, list) or len(value) > _MOST_ENDS:
        raise Refused("'ends' must be a list")
    return tuple(_end(end) for end in value)


def _end(value: object) -> WireEnd:
    if not isinstance(value, Mapping):
        raise Refused("each of 'ends' must be an object with a 'reference'")
    limits = value.get("limits")
    pair = None
    if limits is not None:
        if not isinstance(limits, list) or len(limits) != 2:
            raise Refused("'limits' must be two numbers: [lowest, highest]")
        pair = (_number(limits[0], "limits"), _number(limits[1], "limits"))
    return WireEnd(
        reference=text(value, "reference").strip(),
        scale=_number(value.get("scale", ""), "scale"),
        offset=_number(value.get("offset", ""), "offset"),
        limits=pair,
        unit=text(value, "unit", "").strip(),
    )


def _number(value: object, key: str) -> str:
    """A number as text, so that 1/4 stays 1/4.  The reader of the bindings reports a text that is not a number."""
    if isinstance(value, (int, float)) and not isinstance(value, bool):
        value = repr(value)
    return text({key: value}, key, "").strip()
