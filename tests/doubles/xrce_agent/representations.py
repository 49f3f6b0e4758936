# SPDX-License-Identifier: Apache-2.0
"""The description of an entity in a CREATE, in the binary form.

Source: DDS-XRCE 1.0, 7.7.3 and annex A.
"""

from __future__ import annotations

from dataclasses import dataclass

from .wire import CdrReader, Kind, WireError

BINARY = 3
IS_RELIABLE, IS_KEEP_LAST, IS_TRANSIENT_LOCAL = 0x01, 0x02, 0x08


@dataclass(frozen=True)
class Qos:
    reliable: bool
    keep_last: bool = True
    depth: int | None = None
    transient_local: bool = False


@dataclass(frozen=True)
class Description:
    """An entity as its CREATE describes it; fields that its kind does not have are empty."""

    kind: Kind
    parent: bytes = b""
    """The participant of a topic, publisher or subscriber; the publisher or subscriber of a writer or reader."""
    name: str = ""
    """The name of a participant, or of the topic."""
    type: str = ""
    """The type of the topic."""
    topic: bytes = b""
    """The object id of a writer's or reader's topic."""
    qos: Qos = Qos(reliable=True)
    domain: int = 0
    replies: tuple[str, str] = ("", "")
    """The name and the type of a replier's topic for replies; ``name`` and ``type`` are those of its requests."""


def read_description(payload: CdrReader) -> Description:
    """Reads the description in a CREATE, after its request id and object id."""
    try:
        kind = Kind(payload.u8())
    except ValueError as error:
        raise WireError(str(error)) from None
    form = payload.u8()
    if form != BINARY:
        raise WireError(f"representation {form}")
    content = payload.octets()
    parent, domain = b"", 0
    if kind == Kind.PARTICIPANT:
        domain = payload.number("h")
    else:
        parent = payload.take(2)
    little = payload._order == "<"
    return _binary(kind, CdrReader(content, little), parent, domain)


def _binary(kind: Kind, data: CdrReader, parent: bytes, domain: int) -> Description:
    if kind == Kind.PARTICIPANT:
        if data.flag():
            data.string()  # domain reference
        return Description(kind, name=data.string() if data.flag() else "", domain=domain)
    if kind == Kind.TOPIC:
        name = data.string()
        if data.flag():
            data.string()  # type reference
        return Description(kind, parent, name, data.string() if data.flag() else "")
    if kind in (Kind.PUBLISHER, Kind.SUBSCRIBER):
        return Description(kind, parent)
    if kind == Kind.REPLIER:
        return _binary_replier(data, parent)
    if kind == Kind.REQUESTER:
        raise WireError("this agent has no requesters")
    topic = data.take(2)
    qos = _binary_qos(data) if data.flag() else Qos(reliable=kind == Kind.WRITER)
    return Description(kind, parent, topic=topic, qos=qos)


def _binary_replier(data: CdrReader, parent: bytes) -> Description:
    """Source: ``OBJK_Replier_Binary::deserialize`` of eProsima's agent; here, topics must have names."""
    data.string()  # name of the service, for which the agent has no use
    request_type, reply_type = data.string(), data.string()
    if not data.flag():
        raise WireError("a replier without a topic for requests")
    requests = data.string()
    if not data.flag():
        raise WireError("a replier without a topic for replies")
    replies = data.string()
    return Description(Kind.REPLIER, parent, requests, request_type, replies=(replies, reply_type))


def _binary_qos(data: CdrReader) -> Qos:
    flags = data.u16()
    depth = data.u16() if data.flag() else None
    return Qos(bool(flags & IS_RELIABLE), bool(flags & IS_KEEP_LAST), depth, bool(flags & IS_TRANSIENT_LOCAL))
