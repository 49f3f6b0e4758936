# SPDX-License-Identifier: Apache-2.0
"""The agent's data about one client: the streams of its session, its entities and its requests to read."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Hashable

from .representations import Description, Qos
from .streams import BestEffortInput, BestEffortOutput, Fragments, ReliableInput, ReliableOutput
from .topics import DEPTH, IDENTITY, Endpoint, ReaderEnd, Topics
from .wire import BEST_EFFORT_STREAM, REPLACE, REUSE, Id, Kind, Status, Submessage, WireError, submessage

REPLIER_QOS = Qos(reliable=True, depth=1)
UNLIMITED = 0xFFFF
"""Value of READ_DATA's ``max_samples`` that means no limit."""


class Reading:
    """An active READ_DATA.  Samples wait here; if there are too many, the oldest are dropped, as in a DDS history."""

    def __init__(self, request: bytes, stream: int, samples: int, depth: int) -> None:
        self.request, self.stream = request, stream
        self._left = samples
        self.waiting: deque[bytes] = deque(maxlen=depth)

    @property
    def over(self) -> bool:
        return self._left == 0

    def take(self) -> None:
        """Removes the first waiting sample, which was sent."""
        self.waiting.popleft()
        if self._left != UNLIMITED:
            self._left -= 1


def ros_name(participant: str) -> str:
    """The full name of the ROS 2 node that micro_ros_agent makes of a participant: namespace and name.

    Source: ``GraphManager::get_name_and_namespace`` of micro_ros_agent.  The first part is the namespace; a name
    without a slash has the namespace "/".
    """
    return "/" + participant.removeprefix("/")


class Client:
    def __init__(self, key: bytes, session: int, mtu: int, peer: Hashable, topics: Topics) -> None:
        self.key, self.session, self.mtu, self.peer = key, session, mtu, peer
        self.dead_after: float | None = None
        """Seconds of silence after which the agent asks if the client is alive; None: it never asks."""
        self.heard = 0.0
        """Time of the last frame from the client, in seconds of the agent's clock."""
        self.asked = 0
        """How often the agent has asked since then."""
        self.objects: dict[bytes, Description] = {}
        self.ends: dict[bytes, Endpoint] = {}
        self.reply_ends: dict[bytes, Endpoint] = {}
        """The writer of each replier; ``ends`` has its reader."""
        self.readings: dict[bytes, Reading] = {}
        self._fragments: dict[int, Fragments] = {}
        self._topics = topics
        self.pump: Callable[[Client], None] = lambda client: None
        """Called when samples wait."""
        self.reset_streams()

    def reset_streams(self) -> None:
        self._inputs: dict[int, ReliableInput | BestEffortInput] = {}
        self._reliable: dict[int, ReliableOutput] = {}
        self._best_effort: dict[int, BestEffortOutput] = {}
        # eProsima's agent keeps the fragments that it has collected (ReliableInputStream::reset)

    # Streams ---------------------------------------------------------------------------------------------------------

    def reliable_input(self, stream: int) -> ReliableInput:
        found = self._inputs.setdefault(stream, ReliableInput())
        assert isinstance(found, ReliableInput)
        return found

    def receive(self, stream: int, sequence: int, body: bytes) -> list[bytes]:
        if stream == 0:
            return [body]
        if stream >= 0x80:
            return self.reliable_input(stream).receive(sequence, body)
        return self._inputs.setdefault(stream, BestEffortInput()).receive(sequence, body)

    def fragments(self, stream: int) -> Fragments:
        return self._fragments.setdefault(stream, Fragments())

    def reliable_output(self, stream: int) -> ReliableOutput:
        return self._reliable.setdefault(stream, ReliableOutput(self.session, self.key, stream))

    def push(self, stream: int, content: bytes) -> list[bytes] | None:
        """The messages that carry ``content``; None if the window is full."""
        if stream >= 0x80:
            return self.reliable_output(stream).push(content, self.mtu)
        output = self._best_effort.setdefault(stream, BestEffortOutput(self.session, self.key, stream))
        return output.push(content, self.mtu)

    def heartbeats(self) -> list[bytes]:
        beats = (output.heartbeat() for output in self._reliable.values())
        return [beat for beat in beats if beat is not None]

    # Entities --------------------------------------------------------------------------------------------------------

    @property
    def node(self) -> str:
        """The full name of the ROS 2 node, such as "/lab/robot_1"; "" before the client has a participant."""
        return next((ros_name(d.name) for d in self.objects.values() if d.kind == Kind.PARTICIPANT), "")

    def create(self, identity: bytes, new: Description, flags: int) -> Status:
        """Source: DDS-XRCE 1.0, table 7, for the result if the object exists already."""
        old = self.objects.get(identity)
        if old is not None and not flags & (REUSE | REPLACE):
            return Status.ALREADY_EXISTS
        if old is not None and flags & REUSE:
            if old == new:
                return Status.OK_MATCHED
            if not flags & REPLACE:
                return Status.MISMATCH
        if old is not None:
            self.delete(identity)
        if new.parent and new.parent not in self.objects:
            return Status.UNKNOWN_REFERENCE
        if new.kind in (Kind.WRITER, Kind.READER):
            topic = self.objects.get(new.topic) if new.topic else new
            if topic is None:
                return Status.UNKNOWN_REFERENCE
            self._attach(identity, new, topic)
        if new.kind == Kind.REPLIER:
            self._attach_replier(identity, new)
        self.objects[identity] = new
        return Status.OK

    def _attach_replier(self, identity: bytes, new: Description) -> None:
        """The QoS is that of ``FastDDSMiddleware::create_replier_by_bin`` of eProsima's agent."""
        self._attach(identity, Description(Kind.READER, qos=REPLIER_QOS), new)
        writer = Endpoint(*new.replies, reliable=True, depth=1, node=self.node)
        self.reply_ends[identity] = writer
        self._topics.attach_writer(writer)

    def _attach(self, identity: bytes, new: Description, topic: Description) -> None:
        depth = new.qos.depth or DEPTH
        if new.kind == Kind.WRITER:
            writer = Endpoint(topic.name, topic.type, new.qos.reliable, depth, self.node)
            self.ends[identity] = writer
            self._topics.attach_writer(writer)
            return

        def deliver(data: bytes) -> None:
            reading = self.readings.get(identity)
            if reading is not None and not reading.over:
                reading.waiting.append(data)
                self.pump(self)

        reader = ReaderEnd(topic.name, topic.type, new.qos.reliable, depth, self.node, deliver)
        self.ends[identity] = reader
        self._topics.attach_reader(reader)

    def delete(self, identity: bytes) -> Status:
        if self.objects.pop(identity, None) is None:
            return Status.UNKNOWN_REFERENCE
        self.readings.pop(identity, None)
        end = self.ends.pop(identity, None)
        for each in (end, self.reply_ends.pop(identity, None)):
            if each is not None:
                self._topics.detach(each)
        children = [child for child, d in self.objects.items() if identity in (d.parent, d.topic)]
        for child in children:
            self.delete(child)
        return Status.OK

    def delete_all(self) -> None:
        for identity in list(self.objects):
            self.delete(identity)

    # Data ------------------------------------------------------------------------------------------------------------

    def write(self, identity: bytes, data: bytes) -> None:
        if identity in self.reply_ends:
            if len(data) < IDENTITY:
                raise WireError("a reply without the identity of its request")
            self._topics.reply(self.reply_ends[identity], data[:IDENTITY], data[IDENTITY:])
            return
        writer = self.ends.get(identity)
        if writer is not None and not isinstance(writer, ReaderEnd):
            self._topics.write(writer, data)

    def read(self, payload: Submessage) -> Status:
        """Handles READ_DATA: from now on the client wants the samples of a reader, or no longer."""
        reader = payload.reader
        request = reader.take(4)
        identity = request[2:]
        stream, _format = reader.u8(), reader.u8()
        if reader.flag():
            reader.string()  # content filter
        samples = 1
        if reader.flag():
            samples = reader.u16()
            reader.u16()  # the longest time, which no board of EPG limits
        end = self.ends.get(identity)
        if not isinstance(end, ReaderEnd):
            return Status.UNKNOWN_REFERENCE
        stream = stream or BEST_EFFORT_STREAM
        self.readings[identity] = Reading(request, stream, samples, end.depth)
        return Status.OK

    def next_data(self) -> list[bytes]:
        """Messages with waiting samples, as far as there is space."""
        messages: list[bytes] = []
        for reading in self.readings.values():
            while reading.waiting and not reading.over:
                pushed = self.push(reading.stream, submessage(Id.DATA, reading.request + reading.waiting[0]))
                if pushed is None:
                    break
                messages += pushed
                reading.take()
        return messages
