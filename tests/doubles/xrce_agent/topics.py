# SPDX-License-Identifier: Apache-2.0
"""Topics between boards and tests, in place of DDS: matching of endpoints, and all samples so far.

Endpoints match as in DDS, as far as ROS 2 uses it: same topic, same type; a best-effort writer does not match a
reliable reader.  A :class:`Topics` outlives the agents that use it, as a DDS domain does.
"""

from __future__ import annotations

import itertools
import threading
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass, field

from tests.doubles.waiting import soon

IDENTITY = 24
"""Bytes of the identity of a sample: GUID and sequence number of its writer.  XRCE has it before a request or reply."""
DEPTH = 10
"""Depth of a history by default, as in ROS 2."""


@dataclass(frozen=True)
class Sample:
    number: int
    """The number of samples before it."""
    topic: str
    data: bytes
    """CDR without its encapsulation header."""
    writer: str
    """The board's node name, or "" for a test."""
    request: bytes = b""
    """The identity of the request that this sample answers; b"" for other samples."""


@dataclass(eq=False)
class Endpoint:
    """A reader or a writer."""

    topic: str
    type: str | None
    """None: any type."""
    reliable: bool
    depth: int = DEPTH
    node: str = ""

    def matches(self, reader: Endpoint) -> bool:
        """True if ``reader`` receives the samples of this writer."""
        types = self.type is None or reader.type is None or self.type == reader.type
        return self.topic == reader.topic and types and (self.reliable or not reader.reliable)


@dataclass(eq=False)
class ReaderEnd(Endpoint):
    deliver: Callable[[bytes], None] = field(default=lambda data: None)


class Subscription:
    """The samples that a test receives of a topic, like a peer with this QoS."""

    def __init__(self, topics: Topics, topic: str, type_name: str | None, reliable: bool) -> None:
        self._topics = topics
        self.samples: list[bytes] = []
        self.end = ReaderEnd(topic, type_name, reliable, deliver=self._deliver)
        topics.attach_reader(self.end)

    def _deliver(self, data: bytes) -> None:
        self.samples.append(data)

    def close(self) -> None:
        self._topics.detach(self.end)


class Topics:
    def __init__(self, kept: int = 200_000) -> None:
        self.lock = threading.RLock()
        self._news = threading.Condition(self.lock)
        self._samples: deque[Sample] = deque(maxlen=kept)
        self.readers: list[ReaderEnd] = []
        self.writers: list[Endpoint] = []
        self.count = 0
        """The number of samples so far, which is the number of the next one."""
        self._requests = 0
        self.listeners: list[Callable[[str, Endpoint], None]] = []
        """Called with "attach" or "detach" and the endpoint of a board; a bridge needs this."""
        self.taps: list[Callable[[Endpoint, bytes], None]] = []
        """Called with each sample of a board, and its writer."""

    # Boards and bridges ------------------------------------------------------------------------------------------

    def attach_reader(self, reader: ReaderEnd) -> None:
        with self.lock:
            self.readers.append(reader)
            self._tell("attach", reader)

    def attach_writer(self, writer: Endpoint) -> None:
        with self.lock:
            self.writers.append(writer)
            self._tell("attach", writer)

    def detach(self, end: Endpoint) -> None:
        with self.lock:
            if isinstance(end, ReaderEnd):
                self.readers = [reader for reader in self.readers if reader is not end]
            else:
                self.writers = [writer for writer in self.writers if writer is not end]
            self._tell("detach", end)

    def _tell(self, what: str, end: Endpoint) -> None:
        self._news.notify_all()
        for listener in self.listeners:
            listener(what, end)

    def write(self, writer: Endpoint, data: bytes) -> None:
        """Passes a board's sample to all readers that match."""
        with self.lock:
            self._keep(writer, data)
            self._give(writer, data)
            for tap in self.taps:
                tap(writer, data)
            self._news.notify_all()

    def reply(self, writer: Endpoint, request: bytes, data: bytes) -> None:
        """Takes a board's reply to the request with the identity ``request``."""
        with self.lock:
            self._keep(writer, data, request)
            self._news.notify_all()

    def _keep(self, writer: Endpoint, data: bytes, request: bytes = b"") -> None:
        self._samples.append(Sample(self.count, writer.topic, data, writer.node, request))
        self.count += 1

    def _give(self, writer: Endpoint, data: bytes) -> int:
        matched = [reader for reader in self.readers if writer.matches(reader)]
        for reader in matched:
            reader.deliver(data)
        return len(matched)

    # Tests -------------------------------------------------------------------------------------------------------

    def publish(self, topic: str, data: bytes, reliable: bool = True, type_name: str | None = None) -> int:
        """Publishes like a peer with this QoS; returns the number of readers that match."""
        with self.lock:
            return self._give(Endpoint(topic, type_name, reliable), data)

    def ask(self, service: str, data: bytes, request_type: str | None = None) -> bytes:
        """Sends a request like a service client; ``service`` is such as "/robot_1/enable".  Returns its identity."""
        self._requests += 1
        identity = b"test's requester" + (self._requests << 32).to_bytes(8, "little")
        found = self.publish(f"rq{service}Request", identity + data, type_name=request_type)
        assert found == 1, f"{found} repliers of {service}"
        return identity

    def answers(self, service: str, identity: bytes) -> list[bytes]:
        return [each.data for each in self.samples(f"rr{service}Reply") if each.request == identity]

    def call(self, service: str, data: bytes, seconds: float = 20.0) -> bytes:
        """The reply to a request."""
        identity = self.ask(service, data)
        found = self.wait_until(lambda: bool(self.answers(service, identity)), seconds)
        assert found, f"no answer of {service} within {seconds} s"
        (answer,) = self.answers(service, identity)
        return answer

    def wait_for_service(self, service: str, seconds: float = 20.0) -> None:
        self.wait_for_reader(f"rq{service}Request", seconds)

    def subscribe(self, topic: str, reliable: bool = True, type_name: str | None = None) -> Subscription:
        return Subscription(self, topic, type_name, reliable)

    def samples(self, topic: str, since: int = 0, node: str | None = None) -> list[Sample]:
        """The samples from the number ``since`` on that boards have written, also without a reader."""
        with self.lock:
            newest = itertools.takewhile(lambda sample: sample.number >= since, reversed(self._samples))
            return [each for each in newest if each.topic == topic and node in (None, each.writer)][::-1]

    def newest(self, topic: str, node: str | None = None) -> bytes:
        """The data of the newest sample."""
        with self.lock:
            return next(s.data for s in reversed(self._samples) if s.topic == topic and node in (None, s.writer))

    def clear(self) -> None:
        with self.lock:
            self._samples.clear()

    def wait_until(self, condition: Callable[[], bool], seconds: float) -> bool:
        """True if ``condition`` became true within that time; it is checked at every event."""

        def holds() -> bool:
            with self.lock:
                return condition() or (self._news.wait(0.02) and False)

        return soon(holds, seconds, pause=0.0)  # tests also wait for what does not happen

    def wait_for_sample(self, topic: str, seconds: float = 20.0, node: str | None = None) -> Sample:
        """The next sample that a board writes from now on."""
        since = self.count
        found = self.wait_until(lambda: bool(self.samples(topic, since, node)), seconds)
        assert found, f"nothing on {topic} within {seconds} s"
        return self.samples(topic, since, node)[0]

    def wait_for_reader(self, topic: str, seconds: float = 20.0) -> None:
        """Waits until a board reads ``topic``."""
        found = self.wait_until(lambda: any(reader.topic == topic for reader in self.readers), seconds)
        assert found, f"nobody reads {topic} within {seconds} s"
