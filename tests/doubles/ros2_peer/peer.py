# SPDX-License-Identifier: Apache-2.0
"""A peer on the DDS network that behaves like a ROS 2 node with rmw_cyclonedds and the default QoS of rclpy.

>>> # with Peer(domain=7, node="monitor") as peer:
>>> #     positions = peer.subscription("/pan_publisher", Float64_)
>>> #     peer.spin(1.0)

It reads the ROS graph as `ros2 node list` and `ros2 topic info --verbose` do: from `ros_discovery_info`, and from the
user data of participants, readers and writers.
"""

from __future__ import annotations

import threading
import time
import uuid
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

from cyclonedds.builtin import (
    BuiltinDataReader,
    BuiltinTopicDcpsParticipant,
    BuiltinTopicDcpsPublication,
    BuiltinTopicDcpsSubscription,
)
from cyclonedds.core import (
    DDSStatus,
    Entity,
    InstanceState,
    Policy,
    Qos,
    ReadCondition,
    SampleState,
    ViewState,
    WaitSet,
)
from cyclonedds.domain import DomainParticipant
from cyclonedds.pub import DataWriter
from cyclonedds.sub import DataReader
from cyclonedds.topic import Topic
from cyclonedds.util import duration

from tests.doubles.ros2_peer.definitions import ros_type, type_hash
from tests.doubles.ros2_peer.messages import Gid_, NodeEntitiesInfo_, ParticipantEntitiesInfo_, service_struct
from tests.doubles.waiting import soon

FOREVER = duration(infinite=True)
ANYTHING = SampleState.Any | ViewState.Any | InstanceState.Any


def ros_qos(
    type_: type,
    *,
    reliable: bool = True,
    depth: int | None = 10,
    transient_local: bool = False,
    extra: str = "",
) -> Qos:
    """The QoS of rmw_cyclonedds; by default rclpy's: reliable, keep last 10, volatile.  A depth of None keeps all."""
    policies = [
        Policy.Reliability.Reliable(FOREVER) if reliable else Policy.Reliability.BestEffort,
        Policy.History.KeepAll if depth is None else Policy.History.KeepLast(depth),
        Policy.Durability.TransientLocal if transient_local else Policy.Durability.Volatile,
        Policy.WriterDataLifecycle(autodispose=False),
        Policy.Userdata(f"typehash={type_hash(ros_type(type_.__idl__.idl_transformed_typename))};{extra}".encode()),
    ]
    return Qos(*policies)


def user_data(qos: Qos | None) -> dict[str, str]:
    """``{"typehash": "RIHS01_..."}`` for ``typehash=RIHS01_...;``."""
    policy = qos[Policy.Userdata] if qos is not None else None
    text = bytes(policy.data).decode() if policy is not None else ""
    return dict(pair.split("=", 1) for pair in text.split(";") if "=" in pair)


def _gid(entity: Entity) -> bytes:
    return entity.guid.bytes


@dataclass(frozen=True)
class Endpoint:
    """A reader or writer as in ``ros2 topic info --verbose``; ``node`` is None if no node announces it."""

    topic: str  # "/pan_publisher"
    type: str  # "std_msgs/msg/Float64"
    hash: str | None
    reliable: bool
    volatile: bool
    node: str | None  # "/robot1/JIWY_node"


class Subscription:
    """``received``: messages with the monotonic time of their arrival."""

    def __init__(self, reader: DataReader, callback: Callable[[Any], None] | None) -> None:
        self.reader, self._callback = reader, callback
        self.received: list[tuple[float, Any]] = []

    @property
    def messages(self) -> list[Any]:
        return [message for _, message in self.received]

    @property
    def refused_for(self) -> str | None:
        """The policy for which a writer on this topic did not match, with the name in rclpy's warning."""
        return self._read_status(self.reader.get_requested_incompatible_qos_status())

    @staticmethod
    def _read_status(status: Any) -> str | None:
        names = {11: "RELIABILITY", 2: "DURABILITY"}
        return names.get(status.last_policy_id, "other") if status.total_count else None

    def take(self) -> None:
        now = time.monotonic()  # times of messages, compared with the robots' traces
        for message in self.reader.take(100):
            if message.sample_info.valid_data:
                self.received.append((now, message))
                if self._callback is not None:
                    self._callback(message)


class Publisher:
    def __init__(self, writer: DataWriter) -> None:
        self.writer = writer
        self.sent: list[tuple[float, Any]] = []

    def publish(self, message: Any) -> None:
        self.sent.append((time.monotonic(), message))  # times of messages, compared with the robots' traces
        self.writer.write(message)

    @property
    def matched(self) -> int:
        return len(self.writer.get_matched_subscriptions())

    @property
    def refused_for(self) -> str | None:
        return Subscription._read_status(self.writer.get_offered_incompatible_qos_status())


class Client:
    """Calls a service.  Clients of one peer have different numbers, by which replies are told apart."""

    def __init__(self, peer: Peer, writer: DataWriter, replies: Subscription, request: type) -> None:
        self._peer, self._writer, self._replies, self._request = peer, writer, replies, request
        self._number = id(self) & 0xFFFF_FFFF
        self._sent = 0

    def wait_for_service(self) -> bool:
        """True when both endpoints of the service are known."""
        return self._peer.spin_until(
            lambda: bool(self._writer.get_matched_subscriptions() and self._replies.reader.get_matched_publications())
        )

    def send(self, *values: Any) -> int:
        """Sends a request with these values of its fields; returns its number."""
        self._sent += 1
        self._writer.write(self._request(self._number, self._sent, *values))
        return self._sent

    def reply(self, number: int, timeout: float = 10.0) -> Any:
        """The reply to the request of this number; None if there is none in time."""

        def found() -> list[Any]:
            return [r for r in self._replies.messages if (r.client_guid, r.sequence_number) == (self._number, number)]

        self._peer.spin_until(lambda: bool(found()), timeout)
        return next(iter(found()), None)

    def call(self, *values: Any) -> Any:
        """Sends a request and returns its reply."""
        assert self.wait_for_service()
        return self.reply(self.send(*values))


@dataclass
class Graph:
    """The known participants and endpoints of others, by GUID."""

    enclaves: dict[bytes, str] = field(default_factory=dict)
    nodes: dict[bytes, list[NodeEntitiesInfo_]] = field(default_factory=dict)  # by participant
    writers: dict[bytes, Any] = field(default_factory=dict)
    readers: dict[bytes, Any] = field(default_factory=dict)

    def node_names(self) -> list[str]:
        """The result of ``ros2 node list``: nodes of present participants with an enclave, which are those of ROS 2."""
        return sorted(_full(node) for gid, nodes in self.nodes.items() if gid in self.enclaves for node in nodes)

    def knows_all_of(self, name: str) -> bool:
        """Whether all endpoints are known that a node of a present participant says it has."""
        return all(
            {bytes(gid.data) for gid in node.reader_gid_seq} <= self.readers.keys()
            and {bytes(gid.data) for gid in node.writer_gid_seq} <= self.writers.keys()
            for participant, nodes in self.nodes.items()
            for node in nodes
            if participant in self.enclaves and _full(node) == name
        )

    def _owner(self, gid: bytes, which: str) -> str | None:
        for nodes in self.nodes.values():
            for node in nodes:
                if any(bytes(other.data) == gid for other in getattr(node, which)):
                    return _full(node)
        return None

    def _endpoints(self, samples: dict[bytes, Any], which: str) -> list[Endpoint]:
        found = []
        for gid, sample in samples.items():
            if not sample.topic_name.startswith("rt/"):
                continue
            reliability, durability = sample.qos[Policy.Reliability], sample.qos[Policy.Durability]
            found.append(
                Endpoint(
                    sample.topic_name.removeprefix("rt"),
                    ros_type(sample.type_name),
                    user_data(sample.qos).get("typehash"),
                    reliability != Policy.Reliability.BestEffort,
                    durability == Policy.Durability.Volatile,
                    self._owner(gid, which),
                )
            )
        return sorted(found, key=lambda endpoint: (endpoint.topic, endpoint.node or ""))

    def publications(self) -> list[Endpoint]:
        return self._endpoints(self.writers, "writer_gid_seq")

    def subscriptions(self) -> list[Endpoint]:
        return self._endpoints(self.readers, "reader_gid_seq")


def _full(node: NodeEntitiesInfo_) -> str:
    return node.node_namespace.rstrip("/") + "/" + node.node_name


class Peer:
    """A node.  It handles messages in :meth:`spin`, in the caller's thread."""

    def __init__(self, domain: int, node: str, namespace: str = "/") -> None:
        self.graph = Graph()
        self._node, self._namespace = node, namespace
        self._subscriptions: list[Subscription] = []
        self._publishers: list[Publisher] = []
        self._conditions: list[ReadCondition] = []
        self._participant = DomainParticipant(domain, qos=Qos(Policy.Userdata(b"enclave=/;")))
        self._waitset = WaitSet(self._participant)
        self._builtin = {
            "participants": BuiltinDataReader(self._participant, BuiltinTopicDcpsParticipant),
            "writers": BuiltinDataReader(self._participant, BuiltinTopicDcpsPublication),
            "readers": BuiltinDataReader(self._participant, BuiltinTopicDcpsSubscription),
        }
        topic = Topic(self._participant, "ros_discovery_info", ParticipantEntitiesInfo_)
        info = ParticipantEntitiesInfo_
        self._info_writer = DataWriter(self._participant, topic, qos=ros_qos(info, depth=1, transient_local=True))
        # All participants write one topic without keys: a reader that kept only the last sample would miss some.
        self._info_reader = DataReader(self._participant, topic, qos=ros_qos(info, depth=None, transient_local=True))
        for reader in (*self._builtin.values(), self._info_reader):
            self._attach(reader)
        self._announce()

    def __enter__(self) -> Peer:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """Deletes the participant: others detect at once that it has left."""
        for condition in self._conditions:
            self._waitset.detach(condition)
        for entity in (*self._conditions, self._waitset):
            entity._delete(entity._ref)
        self._conditions.clear()
        self._participant._delete(self._participant._ref)

    def _attach(self, reader: Any) -> None:
        condition = ReadCondition(reader, ANYTHING)
        self._conditions.append(condition)
        self._waitset.attach(condition)

    def _announce(self) -> None:
        """Announces this node's readers and writers, as rmw does whenever one is added."""
        readers = [Gid_(_gid(subscription.reader)) for subscription in self._subscriptions]
        writers = [Gid_(_gid(publisher.writer)) for publisher in self._publishers]
        node = NodeEntitiesInfo_(self._namespace, self._node, readers, writers)
        self._info_writer.write(ParticipantEntitiesInfo_(Gid_(_gid(self._participant)), [node]))

    def subscription(
        self,
        topic: str,
        type_: type,
        *,
        reliable: bool = True,
        depth: int = 10,
        transient_local: bool = False,
        callback: Callable[[Any], None] | None = None,
    ) -> Subscription:
        entity = Topic(self._participant, f"rt{topic}", type_)
        qos = ros_qos(type_, reliable=reliable, depth=depth, transient_local=transient_local)
        reader = DataReader(self._participant, entity, qos=qos)
        reader.set_status_mask(DDSStatus.DataAvailable)
        self._subscriptions.append(Subscription(reader, callback))
        self._attach(reader)
        self._announce()
        return self._subscriptions[-1]

    def publisher(self, topic: str, type_: type, *, reliable: bool = True, depth: int = 10) -> Publisher:
        entity = Topic(self._participant, f"rt{topic}", type_)
        writer = DataWriter(self._participant, entity, qos=ros_qos(type_, reliable=reliable, depth=depth))
        self._publishers.append(Publisher(writer))
        self._announce()
        return self._publishers[-1]

    def raw_publisher(self, topic: str, type_: type) -> Publisher:
        """A publisher with a type of which only the name is known."""
        entity = Topic(self._participant, f"rt{topic}", type_)
        self._publishers.append(
            Publisher(DataWriter(self._participant, entity, qos=Qos(Policy.Reliability.Reliable(FOREVER))))
        )
        return self._publishers[-1]

    def client(self, service: str, type_: str, *, identified: bool = True) -> Client:
        """A client of rmw_cyclonedds for ``/robot_7/JIWY_node/enable`` of the type ``std_srvs/srv/SetBool``.

        A client that is not ``identified`` has no ``clientid``, as those of other implementations.
        """
        request, reply = service_struct(f"{type_}_Request"), service_struct(f"{type_}_Response")
        extra = f"clientid={uuid.uuid4().hex};" if identified else ""
        reader = DataReader(
            self._participant, Topic(self._participant, f"rr{service}Reply", reply), qos=ros_qos(reply, extra=extra)
        )
        writer = DataWriter(
            self._participant,
            Topic(self._participant, f"rq{service}Request", request),
            qos=ros_qos(request, extra=extra),
        )
        subscription = Subscription(reader, None)
        self._subscriptions.append(subscription)
        self._attach(reader)
        return Client(self, writer, subscription, request)

    def spin(self, seconds: float) -> None:
        """Handles messages for this time."""
        self.spin_until(lambda: False, seconds)

    def spin_until(self, done: Callable[[], bool], timeout: float = 20.0) -> bool:
        """Handles messages until ``done()`` is true; False if that has not happened in time."""

        def turn() -> bool:
            for subscription in self._subscriptions:
                subscription.take()
            self._take_graph()
            return done() or bool(self._waitset.wait(duration(seconds=min(timeout, 0.05))) and False)

        return soon(turn, timeout, pause=0.0)  # spin() has no event to wait for

    def _take_graph(self) -> None:
        graph = self.graph
        for sample in self._builtin["participants"].take(100):
            _keep(graph.enclaves, sample, user_data(getattr(sample, "qos", None)).get("enclave"))
        for name, known in (("writers", graph.writers), ("readers", graph.readers)):
            for sample in self._builtin[name].take(1000):
                _keep(known, sample, sample)
        for sample in self._info_reader.take(100):
            if sample.sample_info.valid_data:
                graph.nodes[bytes(sample.gid.data)] = sample.node_entities_info_seq


def _keep(known: dict[bytes, Any], sample: Any, value: Any) -> None:
    gid = sample.key.bytes
    if sample.sample_info.instance_state != InstanceState.Alive:
        known.pop(gid, None)
    elif value is not None:
        known[gid] = value


class Spinner:
    """Spins a peer in its own thread until the end of the ``with`` block."""

    def __init__(self, peer: Peer) -> None:
        self._stop = threading.Event()
        self._thread = threading.Thread(target=peer.spin_until, args=(self._stop.is_set, float("inf")))

    def __enter__(self) -> Spinner:
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._stop.set()
        self._thread.join()
