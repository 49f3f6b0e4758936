# SPDX-License-Identifier: Apache-2.0
"""Frames: messages between zero bytes, beside lines of text.

A frame is a message and its CRC-32, encoded with COBS (S. Cheshire and M. Baker, "Consistent Overhead Byte Stuffing",
IEEE/ACM Transactions on Networking 7(2), 1999), between two zero bytes.

>>> encode(b"C1get").hex()
'000a433167657422bd9c9300'
>>> Decoder().feed(encode(b"C1get") + b"ready\\r\\n")
[b'C1get', 'ready']
"""

from __future__ import annotations

import zlib

LONGEST = 4096
"""Bytes without a zero byte or the end of a line, after which a decoder drops them."""


def encode(message: bytes) -> bytes:
    """The frame of ``message``."""
    data = message + zlib.crc32(message).to_bytes(4, "little")
    runs = []
    for part in data.split(b"\0"):
        *full, last = [part[at : at + 254] for at in range(0, len(part), 254)] or [b""]
        runs += [b"\xff" + run for run in full]
        runs.append(bytes([len(last) + 1]) + last)
    return b"\0" + b"".join(runs) + b"\0"


def decode(data: bytes) -> bytes | None:
    """The message of a frame without its zero bytes, or None if it is damaged."""
    result = bytearray()
    at = 0
    while at < len(data):
        code = data[at]
        run = data[at + 1 : at + code]
        if len(run) != code - 1 or 0 in run:
            return None
        result += run
        at += code
        if code < 255 and at < len(data):
            result.append(0)
    message, crc = bytes(result[:-4]), bytes(result[-4:])
    return message if message and zlib.crc32(message).to_bytes(4, "little") == crc else None


class Decoder:
    """Takes the bytes of a port apart, into messages (bytes) and lines of text (str).  Counts damaged frames."""

    def __init__(self) -> None:
        self.damaged = 0
        self._bytes = b""
        self._after_zero = False

    def feed(self, data: bytes) -> list[bytes | str]:
        """The messages and lines that are complete with ``data``, in their order."""
        messages: list[bytes | str] = []
        *parts, self._bytes = (self._bytes + data).split(b"\0")
        for part in parts:
            message = decode(part) if self._after_zero and part else None
            if message is not None:
                messages.append(message)
            elif part and not self._after_zero:
                messages += _lines(part)
            elif part:
                self.damaged += 1
            self._after_zero = message is None
        if not self._after_zero and b"\n" in self._bytes:
            whole, _, self._bytes = self._bytes.rpartition(b"\n")
            messages += _lines(whole)
        if len(self._bytes) > LONGEST:
            self._bytes = b""
            self._after_zero = False
            self.damaged += 1
        return messages


def _lines(data: bytes) -> list[str]:
    return [line for line in data.decode("ascii", "replace").replace("\r", "").split("\n") if line]
