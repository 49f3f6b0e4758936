# SPDX-License-Identifier: Apache-2.0
"""Serial ports of a target, and the terminal of a host program.

A port belongs to one program at a time.  Others are told which program has it.
"""

from __future__ import annotations

from pathlib import Path

from epg.live.ports import PortError as PortError
from epg.live.ports import system

BAUD = 115200


class SerialPort:
    """An open serial port or terminal, without echo and without a change of any byte.

    :raises PortError: it does not exist, another program has it, or it is no terminal
    """

    def __init__(self, path: Path, baud: int = BAUD) -> None:
        self.path = path
        self._device = system().open_device(path, baud)

    def read(self, seconds: float) -> bytes:
        """The bytes that arrive within ``seconds``; returns as soon as there are some.

        :raises PortError: the port is gone
        """
        return self._device.read(seconds)

    def write(self, data: bytes, seconds: float = 1.0) -> None:
        """Writes ``data``.

        :raises PortError: the port is gone, or took no byte for ``seconds``
        """
        self._device.write(data, seconds)

    def close(self) -> None:
        self._device.close()

    def __enter__(self) -> SerialPort:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()
