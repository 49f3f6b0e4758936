# SPDX-License-Identifier: Apache-2.0
"""The one writer of MCAP files.  Chunks are compressed and indexed; a file is complete when it has been closed."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path

from epg import __version__
from epg.runs.recording import Row


class McapFile:
    """An MCAP file that is being written.  ``chunk`` is the size of its parts in bytes.  Needs the package mcap."""

    def __init__(self, path: Path, profile: str = "", chunk: int = 1024 * 1024) -> None:
        from mcap.writer import Writer

        self._stream = path.open("wb")
        self._writer = Writer(self._stream, chunk_size=chunk)
        self._writer.start(profile=profile, library=f"epg {__version__}")

    def add_schema(self, name: str, encoding: str, definition: str) -> int:
        """The number of a new type of messages."""
        number: int = self._writer.register_schema(name, encoding, definition.encode())
        return number

    def add_channel(self, topic: str, encoding: str, schema: int, metadata: Mapping[str, str] | None = None) -> int:
        """The number of a new channel for the messages of a topic."""
        number: int = self._writer.register_channel(topic, encoding, schema, dict(metadata or {}))
        return number

    def write(self, channel: int, data: bytes, log_time: int, publish_time: int, sequence: int = 0) -> None:
        """Adds a message.  Times are in nanoseconds since 1970."""
        self._writer.add_message(channel, log_time, data, publish_time, sequence)

    def flush(self) -> None:
        """Ends the chunk, because only whole chunks can be read."""
        self._writer.flush()

    def close(self) -> None:
        """Writes the last chunk and the indices."""
        try:
            self._writer.finish()
        finally:
            self._stream.close()


class McapRows:
    """An MCAP file with one JSON message per row.  The first row has the time ``begin``, in ns since 1970."""

    def __init__(self, path: Path, names: Sequence[str], topic: str, begin: int) -> None:
        self._file = McapFile(path)
        properties = {name: {"type": "number"} for name in names}
        schema = json.dumps({"type": "object", "properties": properties})
        self._channel = self._file.add_channel(
            topic, "json", self._file.add_schema("epg.signals", "jsonschema", schema)
        )
        self._names, self._begin = names, begin

    def write(self, rows: Iterable[Row]) -> None:
        for row in rows:
            data = json.dumps(dict(zip(self._names, map(float, row.values), strict=True))).encode()
            stamp = self._begin + round(row.time * 1e9)
            self._file.write(self._channel, data, stamp, stamp)

    def flush(self) -> None:
        self._file.flush()

    def close(self) -> None:
        self._file.close()
