# SPDX-License-Identifier: Apache-2.0
"""Messages of DDS-XRCE on the wire.

Source: OMG, "DDS for eXtremely Resource Constrained Environments" 1.0, chapter 8 and annex A.  Where the standard
leaves a choice, this module follows eProsima's client 2.4.3 and agent 2.4.2.
"""

from __future__ import annotations

import struct
from collections.abc import Iterator
from dataclasses import dataclass
from enum import IntEnum

COOKIE = b"XRCE"
VERSION = b"\x01\x00"
VENDOR = b"\x01\x0f"
AGENT_ID = b"\xff\xfd"
CLIENT_ID = b"\xff\xfe"

NONE_STREAM = 0x00
BEST_EFFORT_STREAM = 0x01
RELIABLE_STREAM = 0x80
WITHOUT_KEY = 0x80
"""From this session id on, headers do not contain the client's key."""

LITTLE_ENDIAN = 0x01
LAST_FRAGMENT = 0x02
REUSE = 0x02
REPLACE = 0x04
FORMAT_MASK = 0x0E

SUBHEADER = 4
SEQUENCES = 0x10000


class WireError(ValueError):
    """A message that ends too early, or has an invalid content."""


class Id(IntEnum):
    CREATE_CLIENT = 0
    CREATE = 1
    GET_INFO = 2
    DELETE = 3
    STATUS_AGENT = 4
    STATUS = 5
    INFO = 6
    WRITE_DATA = 7
    READ_DATA = 8
    DATA = 9
    ACKNACK = 10
    HEARTBEAT = 11
    RESET = 12
    FRAGMENT = 13
    TIMESTAMP = 14
    TIMESTAMP_REPLY = 15


class Kind(IntEnum):
    PARTICIPANT = 1
    TOPIC = 2
    PUBLISHER = 3
    SUBSCRIBER = 4
    WRITER = 5
    READER = 6
    REQUESTER = 7
    REPLIER = 8


class Status(IntEnum):
    OK = 0x00
    OK_MATCHED = 0x01
    DDS_ERROR = 0x80
    MISMATCH = 0x81
    ALREADY_EXISTS = 0x82
    DENIED = 0x83
    UNKNOWN_REFERENCE = 0x84
    INVALID_DATA = 0x85
    INCOMPATIBLE = 0x86
    RESOURCES = 0x87


@dataclass(frozen=True)
class Header:
    session: int
    stream: int
    sequence: int
    key: bytes = b""

    def pack(self) -> bytes:
        key = self.key if self.session < WITHOUT_KEY else b""
        return struct.pack("<BBH", self.session, self.stream, self.sequence) + key


@dataclass(frozen=True)
class Submessage:
    id: int
    flags: int
    payload: bytes

    def pack(self) -> bytes:
        return struct.pack("<BBH", self.id, self.flags, len(self.payload)) + self.payload

    @property
    def reader(self) -> CdrReader:
        return CdrReader(self.payload, little=bool(self.flags & LITTLE_ENDIAN))


def submessage(identity: Id, payload: bytes, flags: int = 0) -> bytes:
    return Submessage(identity, flags | LITTLE_ENDIAN, payload).pack()


def split(data: bytes) -> tuple[Header, bytes]:
    """Splits a message into its header and its submessages."""
    if len(data) < 4:
        raise WireError("no whole header")
    session, stream, sequence = struct.unpack_from("<BBH", data)
    if session >= WITHOUT_KEY:
        return Header(session, stream, sequence), data[4:]
    if len(data) < 8:
        raise WireError("no whole header")
    return Header(session, stream, sequence, data[4:8]), data[8:]


def submessages(body: bytes) -> Iterator[Submessage]:
    """The submessages of a message, each aligned to four bytes."""
    position = 0
    while position + SUBHEADER <= len(body):
        identity, flags, length = struct.unpack_from("<BBH", body, position)
        position += SUBHEADER
        if length > len(body) - position:
            raise WireError(f"submessage {identity} has {len(body) - position} of its {length} bytes")
        yield Submessage(identity, flags, body[position : position + length])
        position += (length + 3) & ~3


class CdrReader:
    """Reads CDR from its start, to which numbers are aligned."""

    def __init__(self, data: bytes, little: bool = True) -> None:
        self.data, self.position = data, 0
        self._order = "<" if little else ">"

    def take(self, size: int, alignment: int = 1) -> bytes:
        start = (self.position + alignment - 1) // alignment * alignment
        if size < 0 or start + size > len(self.data):
            raise WireError(f"{len(self.data)} bytes, and {size} more at {start}")
        self.position = start + size
        return self.data[start : start + size]

    def number(self, code: str) -> int:
        """Reads a number; ``code`` is one of ``struct``'s, such as "H"."""
        size = struct.calcsize(code)
        value: int = struct.unpack(self._order + code, self.take(size, size))[0]
        return value

    def u8(self) -> int:
        return self.number("B")

    def u16(self) -> int:
        return self.number("H")

    def u32(self) -> int:
        return self.number("I")

    def flag(self) -> bool:
        return self.u8() != 0

    def string(self) -> str:
        data = self.take(self.u32())
        if not data.endswith(b"\0"):
            raise WireError("a text without end")
        return data[:-1].decode("utf-8", "replace")

    def octets(self) -> bytes:
        return self.take(self.u32())

    def rest(self) -> bytes:
        return self.take(len(self.data) - self.position)


def later(sequence: int, other: int) -> bool:
    """True if ``sequence`` comes after ``other``, modulo 2^16."""
    return 0 < (sequence - other) % SEQUENCES < SEQUENCES // 2
