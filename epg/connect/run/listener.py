# SPDX-License-Identifier: Apache-2.0
"""The events that a page gets from a running target."""

from __future__ import annotations

import threading
import time
from collections import deque
from typing import Any

from epg.live.buckets import Bucket

PERIOD = 0.05
"""Seconds between two events with points."""
KEPT = 1000
"""Points that wait for a page that reads slowly; older ones are left out."""


class Listener:
    """The events that a page has not read yet."""

    def __init__(self) -> None:
        self._new = threading.Condition()
        self._points: deque[Bucket] = deque(maxlen=KEPT)
        self._lines: deque[str] = deque(maxlen=KEPT)
        self._number: int | None = None
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

    def add_number(self, number: int) -> None:
        """Only the newest number counts."""
        with self._new:
            self._number = number
            self._new.notify()

    def next(self) -> dict[str, Any]:
        """The events since the last call, after at most :data:`PERIOD` seconds."""
        end = time.monotonic() + PERIOD
        with self._new:
            while self._number is None and not self._lines and (left := end - time.monotonic()) > 0:
                self._new.wait(left)
            points, lines, number = list(self._points), list(self._lines), self._number
            self._points.clear()
            self._lines.clear()
            self._number = None
            return {
                "points": [[point.time, point.lows, point.highs] for point in points],
                "lines": lines,
                "number": number,
                "dropped": self._dropped,
            }
