# SPDX-License-Identifier: Apache-2.0
"""The newest rows of a stream, in bounded memory, to save them afterwards.

>>> history = History(2, most=4)
>>> for number in range(3):
...     history.write([Row(number / 1000, [number, 2.0 * number])])
>>> [(row.time, tuple(row.values)) for row in history.rows()]
[(0.001, (1.0, 2.0)), (0.002, (2.0, 4.0))]
"""

from __future__ import annotations

import threading
import time
from array import array
from collections import deque
from collections.abc import Iterable, Iterator

from epg.live.rows import Row

MOST = 4_000_000
"""Values that are kept: 16 MB, which are two minutes of 32 signals at 1 kHz."""


class History:
    """A sink of rows of ``count`` signals that keeps the newest ones, about ``most`` values.

    ``begin`` is the time of the stream's start, in ns since 1970; 0 before the first row.  ``newest`` is the time of
    the newest row; None before the first one.
    """

    def __init__(self, count: int, most: int = MOST) -> None:
        self._count, self._most = count, most
        self._blocks: deque[tuple[array[float], array[float]]] = deque()
        self._kept = 0
        self._lock = threading.Lock()
        self.begin = 0
        self.newest: float | None = None

    def write(self, rows: Iterable[Row]) -> None:
        times, values = array("d"), array("f")
        for row in rows:
            times.append(row.time)
            values.extend(row.values)
        if not times:
            return
        with self._lock:
            self.begin = self.begin or time.time_ns() - round(times[-1] * 1e9)
            self.newest = times[-1]
            self._blocks.append((times, values))
            self._kept += len(values)
            while self._kept > self._most and len(self._blocks) > 1:
                self._kept -= len(self._blocks.popleft()[1])

    def rows(self, begin: float = 0.0) -> Iterator[Row]:
        """The rows from the time ``begin`` on, while others may be written."""
        with self._lock:
            blocks = list(self._blocks)
        for times, values in blocks:
            for index, at in enumerate(times):
                if at >= begin:
                    yield Row(at, values[index * self._count : (index + 1) * self._count])

    def close(self) -> None:
        """Nothing has to be closed."""
