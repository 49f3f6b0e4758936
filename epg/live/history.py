# SPDX-License-Identifier: Apache-2.0
"""The rows of a stream, on the disk, to save them afterwards: an hour of 32 signals at 1 kHz needs 490 MB.

>>> history = History(2, most=32)
>>> for number in range(3):
...     history.write([Row(number / 1000, [number, 2.0 * number])])
>>> [(row.time, row.values) for row in history.rows()]
[(0.001, (1.0, 2.0)), (0.002, (2.0, 4.0))]
>>> history.close()
"""

from __future__ import annotations

import shutil
import struct
import tempfile
import threading
import time
from bisect import bisect_left
from collections import deque
from collections.abc import Iterable, Iterator
from pathlib import Path

from epg.runs.recording import Row

MOST = 2_000_000_000
"""Bytes that are kept: four hours of 32 signals at 1 kHz."""
FREE = 1_000_000_000
"""Bytes of the disk that stay free."""
_PART = 16_000_000  # bytes of a part, the unit in which old rows are left out
_READ = 1_000_000  # bytes that are read at once


class History:
    """A sink of rows of ``count`` signals.  It keeps all of them until they have ``most`` bytes, or the disk is full.

    Then it leaves out the oldest ones.  ``begin`` is the time of the stream's start, in ns since 1970; 0 before the
    first row.  ``newest`` is the time of the newest row; None before the first one.  ``problem`` says why the newest
    rows could not be kept.  The files, in ``folder``, have no names, so they go when the program ends.
    """

    def __init__(self, count: int, most: int = MOST, folder: Path | None = None) -> None:
        self._struct = struct.Struct(f"<d{count}f")
        self._part = max(1, min(_PART, most // 4))
        self._most, self._folder = most, folder
        self._parts: deque[_Part] = deque()
        self._lock = threading.Lock()
        self.begin = 0
        self.newest: float | None = None
        self.problem = ""

    def write(self, rows: Iterable[Row]) -> None:
        pack = self._struct.pack
        packed = [pack(row.time, *row.values) for row in rows]
        if not packed:
            return
        with self._lock:
            first, newest = (self._struct.unpack(row)[0] for row in (packed[0], packed[-1]))
            self.begin = self.begin or time.time_ns() - round(newest * 1e9)
            self.newest = newest
            self._append(b"".join(packed), first)

    def _append(self, data: bytes, begin: float) -> None:
        while True:
            try:
                if not self._parts or self._parts[-1].size >= self._part:
                    self._make_room()
                    self._parts.append(_Part(self._struct, self._folder, begin))
                self._parts[-1].append(data)
                self.problem = ""
                return
            except OSError as error:
                if not self._parts:
                    self.problem = error.strerror or str(error)
                    return
                self._parts.popleft().drop()

    @property
    def count(self) -> int:
        """The number of rows that are kept."""
        return self.size // self._struct.size

    @property
    def size(self) -> int:
        """The number of bytes that are kept."""
        with self._lock:
            return sum(part.size for part in self._parts)

    @property
    def since(self) -> int:
        """The time of the oldest row that is kept, in ns since 1970; 0 before the first row."""
        with self._lock:
            return self.begin + round(self._parts[0].begin * 1e9) if self._parts else 0

    def rows(self, begin: float = 0.0) -> Iterator[Row]:
        """The rows from the time ``begin`` on, while others may be written."""
        with self._lock:
            parts = list(self._parts)
            for part in parts:
                part.readers += 1
            sizes = [part.size for part in parts]
        try:
            for part, size in zip(parts, sizes, strict=True):
                yield from self._rows_of(part, size, begin)
        finally:
            with self._lock:
                for part in parts:
                    part.readers -= 1
                    part.close_if_unused()

    def _rows_of(self, part: _Part, size: int, begin: float) -> Iterator[Row]:
        width = self._struct.size
        with self._lock:
            at = width * bisect_left(range(size // width), begin, key=part.time)
        while at < size:
            with self._lock:
                data = part.read(at, min(_READ // width * width, size - at))
            at += len(data)
            for when, *values in self._struct.iter_unpack(data):
                yield Row(when, tuple(values))

    def close(self) -> None:
        """Leaves out all rows."""
        with self._lock:
            while self._parts:
                self._parts.popleft().drop()

    def _make_room(self) -> None:
        """Leaves out the oldest parts so that one more has room."""
        room = shutil.disk_usage(self._folder or tempfile.gettempdir()).free - FREE - self._part
        size = sum(part.size for part in self._parts)
        while self._parts and (size + self._part > self._most or room < 0):
            room += self._parts[0].size
            size -= self._parts[0].size
            self._parts.popleft().drop()


class _Part:
    """Some rows from the time ``begin`` on, one after another in a file without a name.  Its user holds the lock."""

    def __init__(self, row: struct.Struct, folder: Path | None, begin: float) -> None:
        self._file = tempfile.TemporaryFile(dir=folder, buffering=0)  # noqa: SIM115
        self._row = row
        self._dropped = False
        self.begin = begin
        self.size = 0
        self.readers = 0

    def append(self, data: bytes) -> None:
        self._file.seek(self.size)
        rest = memoryview(data)
        while rest:
            rest = rest[self._file.write(rest) :]
        self.size += len(data)

    def read(self, at: int, size: int) -> bytes:
        self._file.seek(at)
        return self._file.read(size)

    def time(self, index: int) -> float:
        """The time of the row with this index."""
        found: float = self._row.unpack(self.read(index * self._row.size, self._row.size))[0]
        return found

    def drop(self) -> None:
        """Deletes the file, as soon as nobody reads it."""
        self._dropped = True
        self.close_if_unused()

    def close_if_unused(self) -> None:
        if self._dropped and not self.readers:
            self._file.close()
