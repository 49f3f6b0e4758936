# SPDX-License-Identifier: Apache-2.0
"""Frames on a serial line, as eProsima's client and agent send them (HDLC-like byte stuffing).

    7E, source, destination, length (2), payload, CRC of the payload (2)

All bytes after the first are stuffed: 7E and 7D become 7D and the byte xor 20.  The CRC-16 has the polynomial 8005,
reflected, and starts with 0.  The agent's address is 0; it answers to the address that a client has chosen.
"""

from __future__ import annotations

BEGIN, ESCAPE, XOR = 0x7E, 0x7D, 0x20
AGENT = 0


def _table() -> list[int]:
    table = []
    for value in range(256):
        for _ in range(8):
            value = value >> 1 ^ (0xA001 if value & 1 else 0)
        table.append(value)
    return table


_TABLE = _table()


def crc16(data: bytes) -> int:
    crc = 0
    for byte in data:
        crc = crc >> 8 ^ _TABLE[(crc ^ byte) & 0xFF]
    return crc


def frame(payload: bytes, source: int, destination: int) -> bytes:
    plain = bytes([source, destination]) + len(payload).to_bytes(2, "little")
    plain += payload + crc16(payload).to_bytes(2, "little")
    stuffed = bytearray([BEGIN])
    for byte in plain:
        if byte in (BEGIN, ESCAPE):
            stuffed += bytes([ESCAPE, byte ^ XOR])
        else:
            stuffed.append(byte)
    return bytes(stuffed)


class Deframer:
    """Finds frames in a stream of bytes.  It counts bytes that are not a valid frame as broken, and drops them."""

    def __init__(self, address: int = AGENT) -> None:
        self._address = address
        self._data = bytearray()
        self._inside = self._escaped = False
        self.broken = 0

    def feed(self, data: bytes) -> list[tuple[int, bytes]]:
        """The payloads that are now complete, each with its source."""
        payloads = []
        for byte in data:
            if byte == BEGIN:
                self.broken += bool(self._inside and self._data)
                self._data.clear()
                self._inside, self._escaped = True, False
                continue
            if not self._inside:
                continue
            if byte == ESCAPE:
                self._escaped = True
                continue
            self._data.append(byte ^ XOR if self._escaped else byte)
            self._escaped = False
            whole = len(self._data) >= 4 and len(self._data) == 6 + int.from_bytes(self._data[2:4], "little")
            if whole:
                payloads += self._finished()
        return payloads

    def _finished(self) -> list[tuple[int, bytes]]:
        source, destination = self._data[0], self._data[1]
        payload, crc = bytes(self._data[4:-2]), int.from_bytes(self._data[-2:], "little")
        self._data.clear()
        self._inside = False
        if destination != self._address or crc != crc16(payload):
            self.broken += 1
            return []
        return [(source, payload)]
