# SPDX-License-Identifier: Apache-2.0
"""A writer and a reader of std_msgs/msg/Float64 that ROS 2 nodes take for one of theirs."""

# cyclonedds reads annotations as types: no "from __future__ import annotations"

import time
from dataclasses import dataclass

import cyclonedds.idl.annotations as annotate
from cyclonedds.core import InstanceState, Policy, Qos, ReadCondition, SampleState, ViewState, WaitSet
from cyclonedds.domain import DomainParticipant
from cyclonedds.idl import IdlStruct
from cyclonedds.idl.types import float64
from cyclonedds.pub import DataWriter
from cyclonedds.sub import DataReader
from cyclonedds.topic import Topic
from cyclonedds.util import duration


@dataclass
@annotate.final
class Float64(IdlStruct, typename="std_msgs::msg::dds_::Float64_"):
    data: float64


class Endpoint:
    """Writes to one ROS topic (``/ping``) and reads another one (``/pong``)."""

    def __init__(self, domain: int, write: str, read: str, *, write_reliable: bool, read_reliable: bool) -> None:
        self._participant = DomainParticipant(domain)
        self._writer = DataWriter(self._participant, self._topic(write), qos=_qos(write_reliable))
        self._reader = DataReader(self._participant, self._topic(read), qos=_qos(read_reliable))
        self._waitset = WaitSet(self._participant)
        self._waitset.attach(ReadCondition(self._reader, SampleState.Any | ViewState.Any | InstanceState.Any))
        self._names = (write, read)

    def _topic(self, name: str) -> Topic:
        return Topic(self._participant, f"rt{name}", Float64)  # ROS 2 topics stand below "rt" on DDS

    def wait_for_peer(self, seconds: float) -> str:
        """Waits for the reader and the writer of the other program.  Returns "", or the one that is missing."""
        deadline = time.monotonic() + seconds
        while True:
            reads, writes = self._writer.get_matched_subscriptions(), self._reader.get_matched_publications()
            if reads and writes:
                return ""
            if time.monotonic() > deadline:
                missing = [] if reads else [f"no subscriber of {self._names[0]}"]
                missing += [] if writes else [f"no publisher of {self._names[1]}"]
                return " and ".join(missing) + ", or its QoS does not fit"
            time.sleep(0.02)

    def write(self, value: float) -> None:
        self._writer.write(Float64(value))

    def take(self, seconds: float) -> list[float]:
        """All that has arrived, waiting for it for at most ``seconds``."""
        self._waitset.wait(timeout=duration(seconds=seconds))
        return [sample.data for sample in self._reader.take(N=64) if sample.sample_info.valid_data]


def _qos(reliable: bool) -> Qos:
    reliability = Policy.Reliability.Reliable(duration(seconds=1)) if reliable else Policy.Reliability.BestEffort
    return Qos(
        reliability,
        Policy.Durability.Volatile,
        Policy.History.KeepLast(10),
        # plain CDR, as ROS 2 sends it
        Policy.DataRepresentation(use_cdrv0_representation=True, use_xcdrv2_representation=False),
    )
