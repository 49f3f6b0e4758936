# SPDX-License-Identifier: Apache-2.0
"""Finds who was late when a lease has ended: the page, EPG itself, the line, or the target.

Each of them is measured by the time for which it stood still.  If EPG stands still, it can read neither the line nor
the page's answers; if the target does, nothing arrives.  So their times are taken off the times of the others.

>>> Late.of(page=0.9, server=0.05, line=0.06, target=0.0).text
'The page was late: it did not answer for 850 ms.'
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import NamedTuple

from epg.connect.run.answers import Answers
from epg.live.rows import Stream
from epg.runs.recording import Row

SECONDS = 2.0
"""Seconds before the end of a lease that are looked at."""
BEAT = 0.05
"""Seconds between two calls of :meth:`Lateness.beat`."""
NUMBERS = 0.05
"""Seconds between two numbers of a lease."""
_TEXTS = {
    "page": "The page was late: it did not answer for {} ms.",
    "server": "EPG on this computer was late: it stood still for {} ms.",
    "line": "The line was late: nothing arrived from the target for {} ms.",
    "target": "The target was late: it stood still for {} ms.",
}
_REMEDIES = {
    "page": "Keep the page visible, show fewer plots, close other pages and programs, and enable the target again.",
    "server": "Do not suspend this computer, end other programs, and enable the target again.",
    "line": "Look at the cable or the network, end other programs on this computer, and enable the target again.",
    "target": "Look for code on the target that waits, or for a busy computer, and enable the target again.",
}
LEAST = 0.1
"""Seconds of a delay that can have ended a lease of 300 ms, together with shorter ones."""


class Late(NamedTuple):
    """Who was late, in a sentence, and the next steps of the user."""

    who: str
    text: str
    remedy: str

    @staticmethod
    def of(*, page: float, server: float, line: float, target: float) -> Late | None:
        """``page`` and ``line`` are the seconds without an answer or a byte; None if nobody was late.

        ``server`` and ``target`` are the seconds for which they stood still.
        """
        delays = {"target": target, "server": server, "line": line - max(server, target), "page": page - server}
        who = max(delays, key=lambda name: delays[name])
        if delays[who] < LEAST:
            return None
        return Late(who, _TEXTS[who].format(round(1000 * delays[who])), _REMEDIES[who])


class Gaps:
    """The longest gap between two events in the last :data:`SECONDS`.

    >>> gaps = Gaps()
    >>> for at in (0.0, 0.1, 0.9, 1.0): gaps.add(at)
    >>> gaps.longest(1.1)
    0.8
    """

    def __init__(self) -> None:
        self._last: float | None = None
        self._gaps: list[tuple[float, float]] = []

    def add(self, at: float) -> None:
        if self._last is not None:
            self.note(at, at - self._last)
        self._last = at

    def note(self, at: float, length: float) -> None:
        """Adds a gap that has ended at the time ``at``."""
        self._gaps = [*(each for each in self._gaps if each[0] > at - SECONDS), (at, length)]

    def longest(self, at: float) -> float:
        """The longest gap before the time ``at``, which ends the last one."""
        last = at - self._last if self._last is not None else 0.0
        return max([length for when, length in self._gaps if when > at - SECONDS] + [last])


class Lateness:
    """Measures each of them while a lease lasts.  It is a sink of rows, whose times show if the target stood still."""

    def __init__(self, stream: Stream) -> None:
        self._stream = stream
        self._heart, self._stood = Gaps(), Gaps()
        self._row: Row | None = None
        self.begin()

    def begin(self) -> None:
        """A lease begins."""
        self._answers, self._numbers = Answers(), Gaps()

    def beat(self, at: float) -> None:
        """EPG is alive: must be called every :data:`BEAT` seconds."""
        self._heart.add(at)

    def arrived(self, number: int, at: float) -> None:
        """A number of the lease has arrived, and is passed on to the page."""
        self._numbers.add(at)
        self._answers.sent(number, at)

    def answered(self, number: int, at: float) -> None:
        """The page has sent it back."""
        self._answers.returned(number, at)

    def write(self, rows: Iterable[Row]) -> None:
        last = self._row
        *_, self._row = rows
        if last is not None:  # dropped rows have numbers, too; cycles that did not run have none
            stood = self._row.time - last.time - (self._row.number - last.number) * self._stream.period
            self._stood.note(self._row.time, stood)

    def close(self) -> None:
        """Nothing has to be closed."""

    def find(self, ended: float, at: float) -> Late | None:
        """Who was late when a lease has ended at the time ``ended``, shortly before ``at``."""
        answer = max(self._answers.worst(at, SECONDS) or 0.0, self._answers.waiting(ended))
        stood = self._stood.longest(self._row.time if self._row is not None else 0.0)
        heart = self._heart.longest(at) - BEAT
        return Late.of(page=answer, server=heart, line=self._numbers.longest(ended) - NUMBERS, target=stood)
