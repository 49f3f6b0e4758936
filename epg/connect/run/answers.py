# SPDX-License-Identifier: Apache-2.0
"""The answers of a page: how long it takes to send a number back, and if it can keep a target enabled on a lease.

A number is one of the target's lease, or, while there is no lease, a probe of this module, which is negative.
``at`` is the present time in s.

>>> answers = Answers()
>>> answers.probe(1.0), answers.probe(1.01)
(-1, None)
>>> answers.returned(-1, 1.02)
>>> round(answers.worst(1.03), 3), answers.are_in_time(1.03)
(0.02, False)
"""

from __future__ import annotations

import threading
from collections import deque

COUNT = 40
"""Answers that are measured before a target is enabled."""
VALID = 10.0
"""Seconds for which an answer counts."""
LATEST = 0.2
"""Seconds after which an answer is too late: the lease of 300 ms, less the 50 ms between two numbers and a reserve."""
SILENT = 1.0
"""Seconds without an answer after which a page does not answer any more."""
_FIRST, _LATER = 0.05, 0.15
"""Seconds between two probes, until there are enough answers and then."""


class Answers:
    """The numbers that a page was given, and the times of its answers."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._sent: dict[int, float] = {}
        self._times: deque[tuple[float, float]] = deque(maxlen=COUNT)  # of the answer; seconds that it took
        self._probe = 0
        self._due = 0.0

    def probe(self, at: float) -> int | None:
        """The number of a probe that is due; None: there is none yet."""
        if at < self._due:
            return None
        self._due = at + (_LATER if len(self._valid(at)) == COUNT else _FIRST)
        self._probe -= 1
        self.sent(self._probe, at)
        return self._probe

    def sent(self, number: int, at: float) -> None:
        """Notes that the page is given ``number``."""
        with self._lock:
            self._sent = {old: begin for old, begin in self._sent.items() if begin > at - VALID} | {number: at}

    def returned(self, number: int, at: float) -> None:
        """Notes the answer to ``number``.  Numbers before it that the page has left out were answered as late."""
        with self._lock:
            begin = self._sent.get(number)
            if begin is not None:
                self._times.append((at, at - min(self._sent.values())))
                self._sent = {other: sent for other, sent in self._sent.items() if sent > begin}

    def worst(self, at: float, seconds: float = VALID) -> float | None:
        """The longest time of an answer in the last seconds, in s; None: there was none."""
        return max(self._valid(at, seconds), default=None)

    def waiting(self, at: float) -> float:
        """Seconds since the oldest number was sent that the page has not answered."""
        return at - min(self._sent.values(), default=at)

    def are_coming(self, at: float) -> bool:
        """True if the page gets the numbers and answers them."""
        return self.worst(at) is not None and self.waiting(at) < SILENT

    def are_in_time(self, at: float) -> bool:
        """True if enough answers are known, the newest of them were in time, and none is missing."""
        valid = self._valid(at)
        return self.are_coming(at) and len(valid) == COUNT and max(valid[-COUNT // 4 :]) < LATEST

    def _valid(self, at: float, seconds: float = VALID) -> list[float]:
        return [took for when, took in list(self._times) if when > at - seconds]
