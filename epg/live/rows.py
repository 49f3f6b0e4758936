# SPDX-License-Identifier: Apache-2.0
"""The rows of a stream, one after another: with times from the first row on, and a count of the dropped ones.

>>> stream = Stream(("position", "duty"))
>>> found = list(stream.take(Rows(0, 2.5, array("f", [1, 2])))) + list(stream.take(Rows(3, 2.503, array("f", [3, 4]))))
>>> [(round(row.time, 6), tuple(row.values)) for row in found], stream.dropped
([(0.0, (1.0, 2.0)), (0.003, (3.0, 4.0))], 2)
"""

from __future__ import annotations

import contextlib
import json
import time
from array import array
from collections import deque
from collections.abc import Callable, Iterable, Iterator, Sequence
from pathlib import Path
from typing import Protocol, TextIO

from epg.live.client import Client, CommandRefused, Rows
from epg.runs.recording import Row

__all__ = ["File", "JsonLines", "Named", "Recorder", "Sink", "Stream", "array"]

_MODULO = 1 << 32

FLUSH = 0.5
"""Seconds; a file loses no more if this program is killed."""


class Stream:
    """Takes rows as they arrive.  ``rows`` is the number of rows so far, ``dropped`` that of rows that are missing."""

    def __init__(self, names: Sequence[str], period: float = 0.001) -> None:
        self.names = tuple(names)
        self.period = period  # seconds between two rows
        self.rows = 0
        self.dropped = 0
        self._next: int | None = None
        self._begin = 0.0

    def take(self, rows: Rows) -> Iterator[Row]:
        """The single rows."""
        if self._next is None:
            self._begin = rows.tick
        else:
            self.dropped += (rows.number - self._next) % _MODULO
        width = len(self.names)
        count = len(rows.values) // width
        self._next = (rows.number + count) % _MODULO
        self.rows += count
        for index in range(count):
            time = rows.tick - self._begin + index * self.period
            number = (rows.number + index) % _MODULO
            yield Row(time, rows.values[index * width : (index + 1) * width], number)


class Sink(Protocol):
    """Keeps rows."""

    def write(self, rows: Iterable[Row]) -> None: ...


class File(Sink, Protocol):
    """Keeps rows in a file.  Those before :meth:`flush` stay if this program is killed."""

    def flush(self) -> None: ...
    def close(self) -> None: ...


class Named:
    """A file of rows whose errors name it."""

    def __init__(self, path: Path, make: Callable[[], File]) -> None:
        self._path = path
        with self._naming():
            self._file = make()

    def write(self, rows: Iterable[Row]) -> None:
        with self._naming():
            self._file.write(rows)

    def flush(self) -> None:
        with self._naming():
            self._file.flush()

    def close(self) -> None:
        with self._naming():
            self._file.close()

    @contextlib.contextmanager
    def _naming(self) -> Iterator[None]:
        try:
            yield
        except OSError as error:
            raise OSError(error.errno, error.strerror, str(self._path)) from error


class JsonLines:
    """One JSON object per row: its time, and the values by name."""

    def __init__(self, file: TextIO, names: Sequence[str]) -> None:
        self._file, self._names = file, names

    def write(self, rows: Iterable[Row]) -> None:
        for row in rows:
            values = {name: float(f"{value:.9g}") for name, value in zip(self._names, row.values, strict=True)}
            self._file.write(json.dumps({"time": round(row.time, 6), "values": values}) + "\n")
        self._file.flush()


class Recorder:
    """Keeps the rows that arrive until :meth:`drain` writes them into the sinks, in the thread that calls it.

    Those of the sinks that are ``files`` are flushed every :data:`FLUSH` seconds.
    """

    def __init__(self, stream: Stream, sinks: Sequence[Sink], files: Sequence[File] = ()) -> None:
        self.stream, self._sinks, self._files = stream, sinks, files
        self._flush_at = time.monotonic() + FLUSH
        self._arrived: deque[Rows] = deque()

    def start(self, client: Client, signals: Sequence[int], every: int, *, exact: bool = False) -> int:
        """Starts a stream, in every ``every``-th cycle or as often as the transport carries it; returns that number.

        An ``exact`` stream has values with all bits, and has them in every ``every``-th cycle or not at all.

        :raises Refused: the target refused it for another reason
        :raises Lost: the target does not answer
        """
        while True:
            self.stream.period = client.description.period * every
            try:
                client.start_stream(signals, every, self._arrived.append, exact=exact)
            except CommandRefused as refusal:
                words = str(refusal).split(" ")
                if (
                    words[0] != "needs" or exact
                ):  # "needs 17615 bytes per second of 8064 that the transport has for streams"
                    raise
                needed, room = int(words[1]), int(words[6])
                every = max(every + 1, -(-every * needed // room))
                continue
            return every

    def drain(self) -> None:
        """Writes the rows that have arrived.

        :raises OSError: a sink cannot be written
        """
        rows = [row for _ in range(len(self._arrived)) for row in self.stream.take(self._arrived.popleft())]
        for sink in self._sinks if rows else ():
            sink.write(rows)
        if self._files and time.monotonic() >= self._flush_at:
            for file in self._files:
                file.flush()
            self._flush_at = time.monotonic() + FLUSH
