# SPDX-License-Identifier: Apache-2.0
"""The topics of boards on a DDS network: eProsima's agent uses Fast DDS for this, this bridge CycloneDDS for Python.

Every writer and reader of a board gets a counterpart on DDS with the same topic, type and QoS, in a participant with
the name of its node.  The types are those of ``tests.doubles.ros2_peer.messages``; a topic of another type stays
between boards.

>>> with Agent(UdpLink()) as agent, DdsBridge(agent.topics, domain=7):      # doctest: +SKIP
...     ...
"""

from __future__ import annotations

import threading
from typing import Any

from cyclonedds.core import Listener, Policy, Qos
from cyclonedds.domain import DomainParticipant
from cyclonedds.idl import IdlStruct
from cyclonedds.pub import DataWriter
from cyclonedds.sub import DataReader
from cyclonedds.topic import Topic
from cyclonedds.util import duration

from tests.doubles.ros2_peer import messages

from .topics import Endpoint, ReaderEnd, Topics

ENCAPSULATION = b"\x00\x01\x00\x00"
"""The header for CDR, little endian.  It precedes a message on DDS, but not on XRCE."""


def known_types() -> dict[str, Any]:
    """Types by DDS name.  Of several with the same name, the first counts: the others are wrong on purpose."""
    found = [item for item in vars(messages).values() if isinstance(item, type) and issubclass(item, IdlStruct)]
    return {item.__idl__.idl_transformed_typename: item for item in reversed(found) if item is not IdlStruct}


class DdsBridge:
    def __init__(self, topics: Topics, domain: int) -> None:
        self._topics, self._domain = topics, domain
        self._types = known_types()
        self._participants: dict[str, DomainParticipant] = {}
        self._entities: dict[int, Any] = {}
        self._lock = threading.RLock()
        topics.listeners.append(self._changed)
        topics.taps.append(self._written)

    def __enter__(self) -> DdsBridge:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        self._topics.listeners.remove(self._changed)
        self._topics.taps.remove(self._written)
        with self._lock:
            for participant in self._participants.values():
                participant._delete(participant._ref)
            self._participants.clear()
            self._entities.clear()

    def _changed(self, what: str, end: Endpoint) -> None:
        type_ = self._types.get(end.type or "")
        if type_ is None or not end.node:
            return
        with self._lock:
            if what == "attach":
                self._entities[id(end)] = self._entity(end, type_)
            elif id(end) in self._entities:
                entity = self._entities.pop(id(end))
                entity._delete(entity._ref)

    def _entity(self, end: Endpoint, type_: Any) -> Any:
        if end.node not in self._participants:
            self._participants[end.node] = DomainParticipant(self._domain, qos=Qos(Policy.EntityName(end.node)))
        participant = self._participants[end.node]
        policies = (
            Policy.Reliability.Reliable(duration(seconds=1)) if end.reliable else Policy.Reliability.BestEffort,
            Policy.History.KeepLast(end.depth),
            Policy.Durability.Volatile,
        )
        topic = Topic(participant, end.topic, type_)
        if isinstance(end, ReaderEnd):
            return DataReader(participant, topic, qos=Qos(*policies), listener=_Deliver(self._topics, end))
        return DataWriter(participant, topic, qos=Qos(*policies))

    def _written(self, writer: Endpoint, data: bytes) -> None:
        with self._lock:
            entity = self._entities.get(id(writer))
            if isinstance(entity, DataWriter):
                entity.write(self._types[writer.type or ""].deserialize(ENCAPSULATION + data))


class _Deliver(Listener):
    """Passes samples of a DDS reader to the board's reader."""

    def __init__(self, topics: Topics, end: ReaderEnd) -> None:
        super().__init__()
        self._topics, self._end = topics, end

    def on_data_available(self, reader: Any) -> None:
        for message in reader.take(100):
            if message.sample_info.valid_data:
                with self._topics.lock:
                    self._end.deliver(message.serialize()[4:])
