# SPDX-License-Identifier: Apache-2.0
"""ROS 2 messages as CDR without the encapsulation header, which is the form that XRCE carries."""

from __future__ import annotations

import struct
from dataclasses import dataclass

from .wire import CdrReader

LEVELS = ("OK", "WARN", "ERROR", "STALE")


def float64(value: float) -> bytes:
    return struct.pack("<d", value)


def read_float64(data: bytes) -> float:
    assert len(data) == 8, data
    value: float = struct.unpack("<d", data)[0]
    return value


def boolean(value: bool) -> bytes:
    return bytes([value])


@dataclass(frozen=True)
class Diagnostics:
    """A diagnostic_msgs/msg/DiagnosticArray with its single status."""

    stamp: float
    """In seconds."""
    level: str
    name: str
    message: str
    hardware: str
    values: dict[str, str]

    @property
    def state(self) -> str:
        """The message without its warnings, which depend on how busy the computer is."""
        return self.message.split(";")[0]


def read_diagnostics(data: bytes) -> Diagnostics:
    reader = CdrReader(data)
    stamp = reader.number("i") + reader.u32() / 1e9
    assert reader.string() == ""  # frame
    assert reader.u32() == 1
    level = LEVELS[reader.u8()]
    name, message, hardware = reader.string(), reader.string(), reader.string()
    values = {reader.string(): reader.string() for _ in range(reader.u32())}
    assert reader.position == len(data)
    return Diagnostics(stamp, level, name, message, hardware, values)
