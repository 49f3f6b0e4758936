# SPDX-License-Identifier: Apache-2.0
"""A UART of QEMU as the serial line of an agent."""

from __future__ import annotations

import os
import socket

from tests.doubles.xrce_agent.links import SerialLink


class SocketLink(SerialLink):
    """A serial line that is a connection."""

    address = "uart"

    def __init__(self, connection: socket.socket) -> None:
        super().__init__()
        self._connection = connection

    def open(self) -> None:
        if self._file < 0:
            self._file = os.dup(self._connection.fileno())
            os.set_blocking(self._file, False)
