# SPDX-License-Identifier: Apache-2.0
"""MCAP files with ROS 2 messages, in the form in which rosbag2 writes them (rosbag2_storage_mcap).

The definitions of the messages are in the file, so that Foxglove, PlotJuggler and ``ros2 bag`` can read it without any
other file.

>>> # file, channels = open_rosbag2(Path("run.mcap"), [("/pan", "std_msgs/msg/Float64", "reliable", library)])
>>> # file.write(channels[0], cdr, log_time_ns, publish_time_ns, sequence=1)
"""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

from epg.generator.messages.library import Library, complete_definition
from epg.generator.messages.type_hash import type_hash
from epg.runs.mcap_file import McapFile

_CHUNK = 256 * 1024  # bytes

# The numbers of rmw/types.h: history KEEP_LAST, reliability, durability VOLATILE, liveliness AUTOMATIC.  rosbag2 reads
# numbers as well as the names that its newest version writes.
_RELIABILITY = {"reliable": 1, "best_effort": 2}
_INFINITE = "{sec: 9223372036, nsec: 854775807}"


def open_rosbag2(path: Path, topics: Iterable[tuple[str, str, str, Library]]) -> tuple[McapFile, list[int]]:
    """A new file and the numbers of its channels, in the order of ``topics``.

    A topic is its full name, its type, its QoS ("reliable" or "best_effort"), and a library that has loaded the type.
    The messages of a channel are its CDR with the encapsulation header, and are counted from 1 on.
    """
    file = McapFile(path, "ros2", _CHUNK)
    schemas: dict[str, int] = {}
    channels = []
    for name, type_, qos, library in topics:
        if type_ not in schemas:
            schemas[type_] = file.add_schema(type_, "ros2msg", complete_definition(library, type_))
        metadata = {"offered_qos_profiles": _qos_profile(qos), "topic_type_hash": type_hash(library, type_)}
        channels.append(file.add_channel(name, "cdr", schemas[type_], metadata))
    return file, channels


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
