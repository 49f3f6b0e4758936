# SPDX-License-Identifier: Apache-2.0
"""The rows of a stream, one after another: with times from the first row on, and a count of the dropped ones.

>>> stream = Stream(("position", "duty"))
>>> found = list(stream.take(Rows(0, 2.5, array("f", [1, 2])))) + list(stream.take(Rows(3, 2.503, array("f", [3, 4]))))
>>> [(round(row.time, 6), tuple(row.values)) for row in found], stream.dropped
([(0.0, (1.0, 2.0)), (0.003, (3.0, 4.0))], 2)
"""

from __future__ import annotations

import json
from array import array
from collections import deque
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import NamedTuple, Protocol, TextIO

from epg.live.client import Client, Refused, Rows

__all__ = ["CsvFile", "JsonLines", "McapFile", "Recording", "Row", "Sink", "Stream", "array"]

_MODULO = 1 << 32


class Row(NamedTuple):
    """A row: its time in seconds since the first row, one value per signal, and its number.  Dropped rows count."""

    time: float
    values: Sequence[float]
    number: int = 0


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
    def close(self) -> None: ...


class CsvFile:
    """A CSV file: a column of times in seconds, and one column per signal."""

    def __init__(self, path: Path, names: Sequence[str]) -> None:
        self._file = path.open("w", encoding="utf-8", newline="\n")
        self._file.write(",".join(("time", *names)) + "\n")

    def write(self, rows: Iterable[Row]) -> None:
        self._file.writelines(_csv(row) for row in rows)

    def close(self) -> None:
        self._file.close()


def _csv(row: Row) -> str:
    return f"{row.time:.6f}," + ",".join(f"{value:.9g}" for value in row.values) + "\n"


class JsonLines:
    """One JSON object per row: its time, and the values by name."""

    def __init__(self, file: TextIO, names: Sequence[str]) -> None:
        self._file, self._names = file, names

    def write(self, rows: Iterable[Row]) -> None:
        for row in rows:
            values = {name: float(f"{value:.9g}") for name, value in zip(self._names, row.values, strict=True)}
            self._file.write(json.dumps({"time": round(row.time, 6), "values": values}) + "\n")
        self._file.flush()

    def close(self) -> None:
        self._file.flush()


class McapFile:
    """An MCAP file with one JSON message per row.  The first row has the time ``begin``, in ns since 1970."""

    def __init__(self, path: Path, names: Sequence[str], topic: str, begin: int) -> None:
        from mcap.writer import Writer

        from epg import __version__

        self._stream = path.open("wb")
        self._writer = Writer(self._stream)
        self._writer.start(profile="", library=f"epg {__version__}")
        properties = {name: {"type": "number"} for name in names}
        schema = json.dumps({"type": "object", "properties": properties}).encode()
        number = self._writer.register_schema("epg.signals", "jsonschema", schema)
        self._channel = self._writer.register_channel(topic, "json", number)
        self._names, self._begin = names, begin

    def write(self, rows: Iterable[Row]) -> None:
        for row in rows:
            data = json.dumps(dict(zip(self._names, map(float, row.values), strict=True))).encode()
            time = self._begin + round(row.time * 1e9)
            self._writer.add_message(self._channel, time, data, time)

    def close(self) -> None:
        self._writer.finish()
        self._stream.close()


class Recording:
    """Keeps the rows that arrive until :meth:`drain` writes them into the sinks, in the thread that calls it."""

    def __init__(self, stream: Stream, sinks: Sequence[Sink]) -> None:
        self.stream, self._sinks = stream, sinks
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
            except Refused as refusal:
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
