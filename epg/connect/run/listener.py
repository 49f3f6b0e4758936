# SPDX-License-Identifier: Apache-2.0
"""The events that a page gets from a running target."""

from __future__ import annotations

import threading
import time
from collections import deque
from typing import Any

from epg.connect.run.answers import Answers
from epg.live.buckets import Bucket
from epg.live.client import now

PERIOD = 0.05
"""Seconds between two events with points."""
KEPT = 1000
"""Points that wait for a page that reads slowly; older ones are left out."""


class Listener:
    """The events that ``page`` has not read yet, and its answers to their numbers."""

    def __init__(self, page: str) -> None:
        self.page = page
        self.answers = Answers()
        self._new = threading.Condition()
        self._points: deque[Bucket] = deque(maxlen=KEPT)
        self._lines: deque[str] = deque(maxlen=KEPT)
        self._number: int | None = None
        self._moving: int | None = None
        self._dropped = 0

    def add_points(self, points: list[Bucket], dropped: int) -> None:
        with self._new:
            self._points.extend(points)
            self._dropped = dropped
            self._new.notify()

    def add_line(self, line: str) -> None:
        with self._new:
            self._lines.append(line)
            self._new.notify()

    def add_number(self, number: int, at: float) -> None:
        """Only the newest number counts."""
        self.answers.sent(number, at)
        with self._new:
            self._number = number
            self._new.notify()

    def add_moving(self, number: int) -> None:
        """Adds a number for the next request of the page to move by hand.  Only the newest counts."""
        with self._new:
            self._moving = number
            self._new.notify()

    def next(self, *, probes: bool) -> dict[str, Any]:
        """The events since the last call, after at most :data:`PERIOD` seconds.

        With ``probes``, an event without a number of a lease can have that of a probe.
        """
        end = time.monotonic() + PERIOD
        with self._new:
            while not self._has_news() and (left := end - time.monotonic()) > 0:
                self._new.wait(left)
            points, lines, number, moving = list(self._points), list(self._lines), self._number, self._moving
            self._points.clear()
            self._lines.clear()
            self._number = self._moving = None
        at = now()
        if number is None and probes:
            number = self.answers.probe(at)
        return {
            "points": [[point.time, point.lows, point.highs] for point in points],
            "lines": lines,
            "number": number,
            "moving": moving,
            "dropped": self._dropped,
            "worst": self.answers.worst(at),
            "in_time": self.answers.are_in_time(at),
        }

    def _has_news(self) -> bool:
        return self._number is not None or self._moving is not None or bool(self._lines)
