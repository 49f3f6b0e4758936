# SPDX-License-Identifier: Apache-2.0
"""Receives messages by CycloneDDS, without an installed ROS 2.  Other nodes can use any DDS that ROS 2 supports."""

from __future__ import annotations

import time
from collections.abc import Sequence

from cyclonedds.core import InstanceState, Listener, Policy, Qos, ReadCondition, SampleState, ViewState, WaitSet
from cyclonedds.domain import DomainParticipant
from cyclonedds.sub import DataReader
from cyclonedds.topic import Topic
from cyclonedds.util import duration

from epg.ros.dds_types import dds_type
from epg.ros.message_source import Sample, Subscription

_TAKE = 256  # the largest number of samples that are taken at once


class DdsSource:
    """See :class:`epg.ros.message_source.MessageSource`."""

    def __init__(self, subscriptions: Sequence[Subscription], domain: int) -> None:
        self._participant = DomainParticipant(domain)
        self._waitset = WaitSet(self._participant)
        self._listeners = [_Listener() for _ in subscriptions]
        self._readers = []
        every = SampleState.Any | ViewState.Any | InstanceState.Any
        for subscription, listener in zip(subscriptions, self._listeners):
            # In DDS, the names of ROS 2 topics begin with "rt".
            type_ = dds_type(subscription.library, subscription.type)
            topic = Topic(self._participant, f"rt{subscription.name}", type_)
            reader = DataReader(self._participant, topic, qos=_qos(subscription.reliable), listener=listener)
            self._waitset.attach(ReadCondition(reader, every))
            self._readers.append(reader)

    def take(self, seconds: float) -> list[Sample]:
        self._waitset.wait(timeout=duration(seconds=seconds))
        now = time.monotonic_ns()
        return [
            Sample(now, number, message, message.sample_info.source_timestamp, message.serialize)
            for number, reader in enumerate(self._readers)
            for message in reader.take(N=_TAKE)
            if message.sample_info.valid_data
        ]

    def publishers(self) -> list[int]:
        return [
            -1 if listener.incompatible else len(reader.get_matched_publications())
            for reader, listener in zip(self._readers, self._listeners)
        ]

    def close(self) -> None:
        self._readers.clear()
        del self._waitset, self._participant


class _Listener(Listener):  # type: ignore[misc]  # cyclonedds has no types
    """Records that a publisher with an incompatible QoS was found."""

    def __init__(self) -> None:
        self.incompatible = False
        super().__init__()

    def on_requested_incompatible_qos(self, reader: object, status: object) -> None:
        self.incompatible = True


def _qos(reliable: bool) -> Qos:
    reliability = Policy.Reliability.Reliable(duration(seconds=1)) if reliable else Policy.Reliability.BestEffort
    return Qos(
        reliability,
        Policy.Durability.Volatile,
        Policy.History.KeepLast(_TAKE),
        # ROS 2 sends plain CDR.
        Policy.DataRepresentation(use_cdrv0_representation=True, use_xcdrv2_representation=False),
    )
