# SPDX-License-Identifier: Apache-2.0
"""Datagrams that prove that their sender has the key of a console by UDP.  ``docs/live-protocol.md`` defines the bytes.

A sealed datagram is an ordinary one after a head: a number that this program chose at random, one that the target
chose, a counter, and a tag.  Both numbers and the console's key give the key of the connection, and the tag is the
keyed BLAKE2s (RFC 7693) of the direction, the counter and the datagram.  So datagrams of an earlier connection, of the
other direction and of other senders are noticed.  ``udp_seal.c`` of the host is the other side.

>>> here = Seal(bytes(16))
>>> here.open(here.close(b"datagram")) is None  # it comes back to its sender
True
"""

from __future__ import annotations

import hashlib
import hmac
import os
import struct

KEY = 16
"""Bytes of a key."""
AGAIN = 32
"""Flag of a datagram from the target: begin with the number in its head."""

_HEAD = struct.Struct("<4s16s16sQ16s")
_MAGIC = b"\x01EPK"
_FLAGS = 4  # place of the flags in an ordinary datagram
_BITS = 64


class Counters:
    """The counters of the datagrams that have arrived.  Each counts once; one that is far behind the newest is refused.

    >>> counters = Counters()
    >>> [counters.accept(number) for number in (3, 2, 3, 2, 0, 90, 3)]
    [True, True, False, False, False, True, False]
    """

    def __init__(self) -> None:
        self._newest = 0
        self._seen = 1  # bits; the lowest one is the newest

    def accept(self, number: int) -> bool:
        step = number - self._newest
        if step > 0:
            self._seen = (self._seen << min(step, _BITS) | 1) & (1 << _BITS) - 1
            self._newest = number
            return True
        bit = 1 << -step
        if -step >= _BITS or self._seen & bit:
            return False
        self._seen |= bit
        return True


class Seal:
    """The seal of one connection with the console's ``key``."""

    def __init__(self, key: bytes) -> None:
        self._key = key
        self._own = os.urandom(16)
        self._sent = 0
        self.settled = False  # the target has taken up the connection: its number stays
        self._begin(bytes(16))

    def close(self, datagram: bytes) -> bytes:
        """The sealed datagram."""
        self._sent += 1
        tag = _tag(self._session, b"P", self._sent, datagram)
        return _HEAD.pack(_MAGIC, self._own, self._target, self._sent, tag) + datagram

    def open(self, data: bytes) -> bytes | None:
        """The datagram in a sealed one; None if it is not from the target, not new, or not of this connection."""
        if len(data) <= _HEAD.size + _FLAGS:
            return None
        magic, own, target, counter, tag = _HEAD.unpack_from(data)
        if magic != _MAGIC or own != self._own:
            return None
        datagram = data[_HEAD.size :]
        session = self._session if target == self._target else _derive(self._key, own, target)
        if not hmac.compare_digest(tag, _tag(session, b"T", counter, datagram)):
            return None
        if target != self._target:
            if self.settled or not datagram[_FLAGS] & AGAIN:
                return None
            self._begin(target)
        return datagram if self._counters.accept(counter) else None

    def _begin(self, target: bytes) -> None:
        """Goes on with the number that the target has chosen; zeros if it is not known yet."""
        self._target = target
        self._session = _derive(self._key, self._own, target)
        self._counters = Counters()


def _derive(key: bytes, own: bytes, target: bytes) -> bytes:
    return hashlib.blake2s(b"EPG console" + own + target, key=key).digest()


def _tag(session: bytes, direction: bytes, counter: int, datagram: bytes) -> bytes:
    data = direction + counter.to_bytes(8, "little") + datagram
    return hashlib.blake2s(data, key=session, digest_size=16).digest()
