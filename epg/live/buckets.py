# SPDX-License-Identifier: Apache-2.0
"""The least and the greatest value of each signal in short pieces of time, for plots of fast streams.

A plot that shows ten seconds has about a thousand columns of points.  Rows of a millisecond would give it ten times as
many, but leaving rows out would hide short peaks.

>>> buckets = Buckets(1, 0.01)
>>> buckets.write([Row(0.0, [1.0]), Row(0.004, [5.0]), Row(0.008, [3.0]), Row(0.012, [2.0])])
>>> buckets.take()
[Bucket(time=0.0, lows=[1.0], highs=[5.0])]
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import NamedTuple

from epg.runs.recording import Row


class Bucket(NamedTuple):
    """A piece of time: its begin in seconds, and the least and the greatest value of each signal.

    The values of a signal that had only values that are not numbers are None.
    """

    time: float
    lows: list[float | None]
    highs: list[float | None]


class Buckets:
    """A sink of rows of ``count`` signals.  Each piece takes ``width`` seconds."""

    def __init__(self, count: int, width: float) -> None:
        self._count, self._width = count, width
        self._number = -1
        self._bucket = Bucket(0.0, [], [])
        self._finished: list[Bucket] = []

    def write(self, rows: Iterable[Row]) -> None:
        for time, values, _ in rows:
            number = int(time / self._width)
            if number != self._number:
                self._finish()
                self._number = number
                self._bucket = Bucket(number * self._width, [None] * self._count, [None] * self._count)
            lows, highs = self._bucket.lows, self._bucket.highs
            for index, value in enumerate(values):
                low, high = lows[index], highs[index]
                if low is None or high is None:
                    lows[index] = highs[index] = value if value - value == 0 else None
                elif value < low:
                    lows[index] = value
                elif value > high:
                    highs[index] = value

    def take(self) -> list[Bucket]:
        """The pieces that are finished, each once."""
        finished, self._finished = self._finished, []
        return finished

    def _finish(self) -> None:
        if self._number >= 0:
            self._finished.append(self._bucket)
