# SPDX-License-Identifier: Apache-2.0
"""Records the topics of a target or of a system, in the format of the host platform's files.

``topics.csv`` holds the values that the target published, and ``setpoints.csv`` those that were sent to it.  A host
executable can read ``setpoints.csv`` (``--setpoints``).  Times are in seconds since the start of the recording, by the
clock of the computer that records.

``recording.mcap`` holds all messages as they were sent.  The log time of a message is the time of the control cycle to
which its values belong, if the message has a stamp; otherwise it is the time of arrival.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from contextlib import nullcontext
from dataclasses import replace
from pathlib import Path

from epg.generator.dataclass import dataclass
from epg.generator.messages.library import Library
from epg.ros.message_source import MessageSource, Sample, Subscription
from epg.ros.messages import library_of, numbers
from epg.ros.rosbag2 import open_rosbag2
from epg.runs.csv_file import CsvFile
from epg.runs.recording import ROWS, Row
from epg.runs.robot import Robot, RobotTopic

SETPOINTS, TOPICS, MCAP = "setpoints.csv", "topics.csv", "recording.mcap"

_TURN = 0.1  # seconds between two checks whether the recording must end

_FLUSH = 0.5
"""Seconds; the files lose no more if this program is killed."""

_NEAR = 10_000_000_000
"""The longest time in nanoseconds between the stamp of a message and its arrival, if both are by the same time.

A board whose clock has not been set counts from its start, and a simulated robot has simulated time.
"""


@dataclass(frozen=True)
class Channel:
    """A topic to record, its full name, the file for its values, and the library with its type."""

    topic: RobotTopic
    name: str
    file: str
    library: Library

    @property
    def subscription(self) -> Subscription:
        """The subscription for this topic.

        For setpoints it is best effort, because any node can publish them, with any QoS.  For topics of the target it
        is reliable if the target publishes reliably.
        """
        reliable = self.file == TOPICS and self.topic.qos == "reliable"
        return Subscription(self.name, self.topic.type, reliable, self.library)


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
            library = library_of(robot, topic.type)
            if library is None:
                unknown.append(topic)
            else:
                channels.append(Channel(topic, robot.topic(topic), file, library))
    return channels, unknown


def channels_of_system(robots: Sequence[Robot]) -> tuple[list[Channel], list[RobotTopic]]:
    """The same for all targets of a system.

    A topic is recorded once.  It is a setpoint if no target publishes it.  The values have the names that the
    simulation of the system gives them: an absolute topic keeps its name, the target comes before another one.
    """
    found = [channels_of(_named_by_target(robot)) for robot in robots]
    channels: dict[str, Channel] = {}
    for channel in (channel for several, _ in found for channel in several):
        if channel.name not in channels or channel.file == TOPICS:
            channels[channel.name] = channel
    setpoints_first = sorted(channels.values(), key=lambda channel: channel.file)
    return setpoints_first, [topic for _, several in found for topic in several]


def _named_by_target(robot: Robot) -> Robot:
    """The target with its name before the names of its values, except those of absolute topics."""

    def named(topic: RobotTopic) -> RobotTopic:
        absolute = topic.name.startswith("/")
        return topic if absolute else replace(topic, values=tuple(f"{robot.name}/{value}" for value in topic.values))

    return replace(
        robot,
        subscriptions=tuple(named(topic) for topic in robot.subscriptions),
        publications=tuple(named(topic) for topic in robot.publications),
    )


def record(
    source: MessageSource,
    channels: Sequence[Channel],
    folder: Path,
    duration: float | None,
    stopped: Callable[[], bool],
    progress: Callable[[str], None] = lambda text: None,
    mcap: bool = False,
) -> list[Heard]:
    """Writes the files in ``folder`` until ``duration`` seconds are over, or until ``stopped()`` returns True.

    If ``duration`` is None, only ``stopped()`` ends the recording.  ``mcap`` writes an MCAP file beside the CSV files.
    """
    folder.mkdir(parents=True, exist_ok=True)
    begin = time.monotonic_ns()
    counts = [_Count() for _ in channels]
    with (
        CsvFile(folder / SETPOINTS, ROWS[1:], value="%s") as setpoints,
        CsvFile(folder / TOPICS, ROWS[1:], value="%s") as topics,
        _Messages(folder / MCAP, channels) if mcap else nullcontext() as messages,
    ):
        files = {SETPOINTS: setpoints, TOPICS: topics}
        flushed = 0.0
        while not stopped():
            elapsed = 1e-9 * (time.monotonic_ns() - begin)
            if duration is not None and elapsed >= duration:
                break
            rest = _TURN if duration is None else min(_TURN, duration - elapsed)
            for sample in source.take(rest):
                channel = channels[sample.subscription]
                counts[sample.subscription].add(sample.time_ns)
                _write(files[channel.file], channel, sample, begin)
                if messages is not None:
                    messages.write(sample, counts[sample.subscription].messages)
            if elapsed >= flushed + _FLUSH:
                for file in files.values():
                    file.flush()
                if messages is not None:
                    messages.flush()
                flushed = elapsed
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


class _Messages:
    """The MCAP file of a recording."""

    def __init__(self, path: Path, channels: Sequence[Channel]) -> None:
        # One reading of the clock: the times of a recording do not jump when the computer's clock is set.
        self._to_wall = time.time_ns() - time.monotonic_ns()
        topics = [(channel.name, channel.topic.type, channel.topic.qos, channel.library) for channel in channels]
        self._file, self._channels = open_rosbag2(path, topics)

    def write(self, sample: Sample, sequence: int) -> None:
        arrival = sample.time_ns + self._to_wall
        stamp = getattr(getattr(sample.message, "header", None), "stamp", None)
        stamped = 0 if stamp is None else stamp.sec * 1_000_000_000 + stamp.nanosec
        log_time = stamped if abs(stamped - arrival) <= _NEAR else arrival
        channel, published = self._channels[sample.subscription], sample.published_ns or log_time
        self._file.write(channel, sample.cdr(), log_time, published, sequence)

    def flush(self) -> None:
        self._file.flush()

    def __enter__(self) -> _Messages:
        return self

    def __exit__(self, *_: object) -> None:
        self._file.close()


def _write(file: CsvFile, channel: Channel, sample: Sample, begin: int) -> None:
    seconds = 1e-9 * (sample.time_ns - begin)
    values = zip(channel.topic.values, numbers(channel.topic, sample.message))
    file.write(Row(seconds, value) for value in values if value[1] is not None)
