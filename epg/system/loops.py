# SPDX-License-Identifier: Apache-2.0
"""Loops: targets whose values come back to them through other targets."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable, Mapping


def loops_of(pairs: Iterable[tuple[str, str]]) -> list[tuple[str, ...]]:
    """The shortest loop through each target that has one, without repetitions.

    ``pairs`` are senders and receivers.  A loop begins at its first target in the order of ``pairs``.

    >>> loops_of([("a", "b"), ("b", "c"), ("c", "a"), ("c", "d")])
    [('a', 'b', 'c')]
    """
    receivers: dict[str, list[str]] = {}
    for sender, receiver in dict.fromkeys(pairs):
        receivers.setdefault(sender, []).append(receiver)
    found: dict[frozenset[str], tuple[str, ...]] = {}
    for start in receivers:
        loop = _shortest(start, receivers)
        if loop:
            found.setdefault(frozenset(loop), loop)
    return list(found.values())


def _shortest(start: str, receivers: Mapping[str, list[str]]) -> tuple[str, ...]:
    """The shortest way from ``start`` back to it, without its end; empty if there is none."""
    waiting: deque[tuple[str, ...]] = deque([(start,)])
    seen: set[str] = set()
    while waiting:
        way = waiting.popleft()
        for receiver in receivers.get(way[-1], ()):
            if receiver == start:
                return way
            if receiver not in seen:
                seen.add(receiver)
                waiting.append((*way, receiver))
    return ()
