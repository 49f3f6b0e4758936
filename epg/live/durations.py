# SPDX-License-Identifier: Apache-2.0
"""Histograms of durations, such as the computation times of the control cycles.

A bin is a quarter of an octave wide, so a microsecond and a millisecond are seen equally well.

>>> durations = Durations([0])
>>> durations.write([Row(0.0, [0.0]), Row(0.001, [1000.0]), Row(0.002, [1100.0]), Row(0.003, [4000.0])])
>>> durations.histograms[0].data()
{'rows': 3, 'median': 1024, 'most': 4000, 'bins': [[39, 1], [40, 1], [47, 1]]}
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterable, Sequence
from typing import Any

from epg.runs.recording import Row

BINS = 4
"""Bins per octave."""


class Histogram:
    """Counts durations in ns."""

    def __init__(self) -> None:
        self._counts: Counter[int] = Counter()
        self._most = 0.0

    def add(self, duration: float) -> None:
        self._counts[math.floor(BINS * math.log2(max(duration, 1.0)))] += 1
        self._most = max(self._most, duration)

    def data(self) -> dict[str, Any]:
        """The number of durations, the begin of the median's bin, the longest one, and the count of each bin.

        Bin b begins at 2^(b / BINS) ns.
        """
        counts = dict(self._counts)  # another thread may add one
        rows, seen, median = sum(counts.values()), 0, 0
        for number in sorted(counts):
            seen += counts[number]
            if 2 * seen >= rows:
                median = number
                break
        bins = [[number, counts[number]] for number in sorted(counts)]
        return {"rows": rows, "median": round(2 ** (median / BINS)), "most": round(self._most), "bins": bins}


class Durations:
    """A sink of rows that counts the values in ``columns``.  The first row, which has no durations yet, is left out."""

    def __init__(self, columns: Sequence[int]) -> None:
        self._columns = tuple(columns)
        self._begun = False
        self.histograms = tuple(Histogram() for _ in columns)

    def write(self, rows: Iterable[Row]) -> None:
        for row in rows:
            if self._begun:
                for column, histogram in zip(self._columns, self.histograms, strict=True):
                    histogram.add(row.values[column])
            self._begun = True
