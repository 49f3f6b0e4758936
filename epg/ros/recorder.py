# SPDX-License-Identifier: Apache-2.0
"""Records the topics of a target, in the format of the host platform's files.

``topics.csv`` holds the values that the target published, and ``setpoints.csv`` those that were sent to it.  A host
executable can read ``setpoints.csv`` (``--setpoints``).  Times are in seconds since the start of the recording, by the
clock of the computer that records.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TextIO

from epg.ros.messages import TYPES, numbers
from epg.ros.robot import Robot, RobotTopic
from epg.ros.source import Sample, Source, Subscription

SETPOINTS, TOPICS = "setpoints.csv", "topics.csv"

_TURN = 0.1  # seconds between two checks whether the recording must end


@dataclass(frozen=True)
class Channel:
    """A topic to record, its full name, and the file for its values."""

    topic: RobotTopic
    name: str
    file: str

    @property
    def subscription(self) -> Subscription:
        """The subscription for this topic.

        For setpoints it is best effort, because any node can publish them, with any QoS.  For topics of the target it
        is reliable if the target publishes reliably.
        """
        return Subscription(self.name, self.topic.type, self.file == TOPICS and self.topic.qos == "reliable")


@dataclass(frozen=True)
class Heard:
    """The result of recording one channel.

    ``messages`` is the number of messages, ``span`` the time in seconds from the first to the last one.  ``publishers``
    is the number of publishers that were found, or -1 if one has an incompatible QoS.
    """

    channel: Channel
    messages: int
    span: float
    publishers: int

    @property
    def rate(self) -> float:
        """Messages per second; 0 if there are fewer than two messages."""
        return (self.messages - 1) / self.span if self.messages > 1 and self.span > 0.0 else 0.0


def channels_of(robot: Robot) -> tuple[list[Channel], list[RobotTopic]]:
    """The channels that can be recorded of a target, and its topics whose type EPG does not know."""
    channels, unknown = [], []
    for topics, file in ((robot.subscriptions, SETPOINTS), (robot.publications, TOPICS)):
        for topic in topics:
            if topic.role != "values":
                continue
            if topic.type in TYPES:
                channels.append(Channel(topic, robot.topic(topic), file))
            else:
                unknown.append(topic)
    return channels, unknown


def record(
    source: Source,
    channels: Sequence[Channel],
    folder: Path,
    duration: float | None,
    stopped: Callable[[], bool],
    progress: Callable[[str], None] = lambda text: None,
) -> list[Heard]:
    """Writes both files in ``folder`` until ``duration`` seconds are over, or until ``stopped()`` returns True.

    If ``duration`` is None, only ``stopped()`` ends the recording.
    """
    folder.mkdir(parents=True, exist_ok=True)
    begin = time.monotonic_ns()
    counts = [_Count() for _ in channels]
    with (
        (folder / SETPOINTS).open("w", encoding="utf-8", newline="\n") as setpoints,
        (folder / TOPICS).open("w", encoding="utf-8", newline="\n") as topics,
    ):
        files = {SETPOINTS: setpoints, TOPICS: topics}
        for file in files.values():
            file.write("time,topic,value\n")
        while not stopped():
            elapsed = 1e-9 * (time.monotonic_ns() - begin)
            if duration is not None and elapsed >= duration:
                break
            rest = _TURN if duration is None else min(_TURN, duration - elapsed)
            for sample in source.take(rest):
                channel = channels[sample.subscription]
                counts[sample.subscription].add(sample.time_ns)
                _write(files[channel.file], channel, sample, begin)
            progress(f"{elapsed:.0f} s, {sum(count.messages for count in counts)} messages")
    publishers = source.publishers()
    return [Heard(c, count.messages, count.span, p) for c, count, p in zip(channels, counts, publishers)]


class _Count:
    def __init__(self) -> None:
        self.messages, self.first, self.last = 0, 0, 0

    def add(self, time_ns: int) -> None:
        self.first = self.first or time_ns
        self.last = time_ns
        self.messages += 1

    @property
    def span(self) -> float:
        return 1e-9 * (self.last - self.first)


def _write(file: TextIO, channel: Channel, sample: Sample, begin: int) -> None:
    seconds = f"{1e-9 * (sample.time_ns - begin):.6f}"
    for name, value in zip(channel.topic.values, numbers(channel.topic, sample.message)):
        if value is not None:
            file.write(f"{seconds},{name},{value!r}\n")
