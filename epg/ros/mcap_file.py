# SPDX-License-Identifier: Apache-2.0
"""Writes ROS 2 messages into an MCAP file, in the form in which rosbag2 writes it (rosbag2_storage_mcap).

The definitions of the messages are in the file, so that Foxglove, PlotJuggler and ``ros2 bag`` can read it without any
other file.  Chunks are compressed and indexed.  The file is complete when it has been closed.

>>> # with McapFile(Path("run.mcap")) as file:
>>> #     pan = file.add_channel("/pan_publisher", "std_msgs/msg/Float64", "reliable", known_message(...))
>>> #     file.write(pan, cdr, log_time_ns, publish_time_ns)
"""

from __future__ import annotations

from pathlib import Path
from types import TracebackType

from mcap.writer import Writer

from epg import __version__
from epg.messages.library import Library, complete_definition
from epg.messages.type_hash import type_hash

_CHUNK = 256 * 1024  # bytes; a program that crashes loses at most this much

# The numbers of rmw/types.h: history KEEP_LAST, reliability, durability VOLATILE, liveliness AUTOMATIC.  rosbag2 reads
# numbers as well as the names that its newest version writes.
_RELIABILITY = {"reliable": 1, "best_effort": 2}
_INFINITE = "{sec: 9223372036, nsec: 854775807}"


class McapFile:
    """An MCAP file that is being written."""

    def __init__(self, path: Path) -> None:
        self._stream = path.open("wb")
        self._writer = Writer(self._stream, chunk_size=_CHUNK)
        self._writer.start(profile="ros2", library=f"epg {__version__}")
        self._schemas: dict[str, int] = {}
        self._sequences: dict[int, int] = {}

    def add_channel(self, topic: str, type_: str, qos: str, library: Library) -> int:
        """The number of a new channel for the messages of a topic.

        ``topic`` is its full name, ``qos`` is "reliable" or "best_effort".  ``library`` has loaded the message
        ``type_``.
        """
        if type_ not in self._schemas:
            definition = complete_definition(library, type_).encode()
            self._schemas[type_] = self._writer.register_schema(type_, "ros2msg", definition)
        metadata = {"offered_qos_profiles": _qos_profile(qos), "topic_type_hash": type_hash(library, type_)}
        channel: int = self._writer.register_channel(topic, "cdr", self._schemas[type_], metadata)
        self._sequences[channel] = 0
        return channel

    def write(self, channel: int, cdr: bytes, log_time: int, publish_time: int) -> None:
        """Adds a message: its CDR with the encapsulation header.  Times are in nanoseconds since 1970."""
        self._sequences[channel] += 1
        self._writer.add_message(channel, log_time, cdr, publish_time, self._sequences[channel])

    def close(self) -> None:
        """Writes the last chunk and the indices."""
        self._writer.finish()
        self._stream.close()

    def __enter__(self) -> McapFile:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, problem: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()


def _qos_profile(qos: str) -> str:
    """The YAML text that rosbag2 keeps for a topic, so that ``ros2 bag play`` publishes with this QoS."""
    lines = {
        "history": 1,
        "depth": 10,
        "reliability": _RELIABILITY[qos],
        "durability": 2,
        "deadline": _INFINITE,
        "lifespan": _INFINITE,
        "liveliness": 1,
        "liveliness_lease_duration": _INFINITE,
        "avoid_ros_namespace_conventions": "false",
    }
    first, *others = (f"{key}: {value}\n" for key, value in lines.items())
    return f"- {first}" + "".join(f"  {line}" for line in others)
