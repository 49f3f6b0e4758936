# SPDX-License-Identifier: Apache-2.0
"""Streams of a session.  Reliable ones number, store, acknowledge and repeat; best-effort ones drop old messages.

Source: DDS-XRCE 1.0, 8.4; windows of 16 messages as in eProsima's agent.
"""

from __future__ import annotations

from collections import OrderedDict

from .wire import (
    LAST_FRAGMENT,
    LITTLE_ENDIAN,
    SEQUENCES,
    SUBHEADER,
    Header,
    Id,
    Submessage,
    later,
    submessage,
)

WINDOW = 16


class BestEffortInput:
    def __init__(self) -> None:
        self._last = SEQUENCES - 1

    def receive(self, sequence: int, body: bytes) -> list[bytes]:
        if not later(sequence, self._last):
            return []
        self._last = sequence
        return [body]


class ReliableInput:
    """Returns every message once, in order."""

    def __init__(self) -> None:
        self._next = 0
        self._announced = SEQUENCES - 1
        self._stored: dict[int, bytes] = {}

    def receive(self, sequence: int, body: bytes) -> list[bytes]:
        if (sequence - self._next) % SEQUENCES < WINDOW:
            self._stored.setdefault(sequence, body)
            if later(sequence, self._announced):
                self._announced = sequence
        return self._ready()

    def _ready(self) -> list[bytes]:
        ready = []
        while self._next in self._stored:
            ready.append(self._stored.pop(self._next))
            self._next = (self._next + 1) % SEQUENCES
        return ready

    def heartbeat(self, first: int, last: int) -> list[bytes]:
        """The numbers of the messages that the sender still has.  Earlier messages cannot arrive any more."""
        if later(first, self._next):
            self._next = first
            self._stored = {number: body for number, body in self._stored.items() if not later(first, number)}
        if later(last, self._announced):
            self._announced = last
        return self._ready()

    def acknack(self, stream: int) -> bytes:
        missing = 0
        count = min((self._announced - self._next + 1) % SEQUENCES, WINDOW)
        for bit in range(count):
            if (self._next + bit) % SEQUENCES not in self._stored:
                missing |= 1 << bit
        payload = self._next.to_bytes(2, "little") + missing.to_bytes(2, "big") + bytes([stream])
        return submessage(Id.ACKNACK, payload)


class Fragments:
    """Joins the fragments of submessages."""

    def __init__(self) -> None:
        self._data = b""

    def add(self, piece: Submessage) -> bytes | None:
        self._data += piece.payload
        if not piece.flags & LAST_FRAGMENT:
            return None
        whole, self._data = self._data, b""
        return whole


class BestEffortOutput:
    def __init__(self, session: int, key: bytes, stream: int) -> None:
        self._session, self._key, self._stream = session, key, stream
        self._next = 0

    def push(self, content: bytes, mtu: int) -> list[bytes]:
        """Messages to send; none if the content is too large, because this stream has no fragments."""
        header = Header(self._session, self._stream, self._next, self._key).pack()
        if len(header) + len(content) > mtu:
            return []
        self._next = (self._next + 1) % SEQUENCES
        return [header + content]


class ReliableOutput:
    def __init__(self, session: int, key: bytes, stream: int) -> None:
        self._session, self._key, self._stream = session, key, stream
        self._next = 0
        self._unacknowledged: OrderedDict[int, bytes] = OrderedDict()

    def push(self, content: bytes, mtu: int) -> list[bytes] | None:
        """Messages to send now; None if the window is full.

        As in eProsima's agent, the fragments of one submessage are sent at once, also if the window is full then.
        """
        if len(self._unacknowledged) >= WINDOW - 1:
            return None
        room = mtu - len(Header(self._session, self._stream, 0, self._key).pack())
        bodies = [content]
        if len(content) > room:
            size = room - SUBHEADER
            pieces = [content[at : at + size] for at in range(0, len(content), size)]
            flags = [0] * (len(pieces) - 1) + [LAST_FRAGMENT]
            bodies = [submessage(Id.FRAGMENT, piece, flag | LITTLE_ENDIAN) for piece, flag in zip(pieces, flags)]
        messages = []
        for body in bodies:
            messages.append(Header(self._session, self._stream, self._next, self._key).pack() + body)
            self._unacknowledged[self._next] = messages[-1]
            self._next = (self._next + 1) % SEQUENCES
        return messages

    def acknack(self, first: int, missing: int) -> list[bytes]:
        """The messages that the other side requests again."""
        if not later(first, self._next):
            while self._unacknowledged and later(first, next(iter(self._unacknowledged))):
                self._unacknowledged.popitem(last=False)
        wanted = [(first + bit) % SEQUENCES for bit in range(WINDOW) if missing >> bit & 1]
        return [self._unacknowledged[number] for number in wanted if number in self._unacknowledged]

    def heartbeat(self) -> bytes | None:
        """A heartbeat, to be sent from time to time while messages are not acknowledged."""
        if not self._unacknowledged:
            return None
        first, last = next(iter(self._unacknowledged)), (self._next - 1) % SEQUENCES
        payload = first.to_bytes(2, "little") + last.to_bytes(2, "little") + bytes([self._stream])
        return submessage(Id.HEARTBEAT, payload)
