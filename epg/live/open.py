# SPDX-License-Identifier: Apache-2.0
"""Opens the port of a target by its name: a serial port, the terminal of a host program, or ``udp:HOST:PORT``."""

from __future__ import annotations

from pathlib import Path

from epg.live.port import BAUD, SerialPort
from epg.live.udp import UdpPort, is_udp


def open_port(path: Path, baud: int = BAUD) -> SerialPort | UdpPort:
    """The open port.

    :raises PortError: it cannot be used
    """
    return UdpPort(path) if is_udp(path) else SerialPort(path, baud)
