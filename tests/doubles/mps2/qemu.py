# SPDX-License-Identifier: Apache-2.0
"""Runs a program on one of Arm's MPS2 boards in QEMU; each UART of the board is a connection to the test.

>>> # with Board("mps2-an385", image, uarts=1) as board:
>>> #     board.lines[0].sendall(b"...")
"""

from __future__ import annotations

import shutil
import socket
import subprocess
from collections.abc import Sequence
from pathlib import Path

from tests.doubles.toolchain import Missing

PATIENCE = 60.0
"""Seconds to wait for a byte, on a machine that also runs other programs."""


def qemu() -> str:
    program = shutil.which("qemu-system-arm")
    if program is None:
        raise Missing("qemu-system-arm is not installed: sudo apt install qemu-system-arm")
    return program


class Board:
    """A board that runs; ``lines`` are its UARTs."""

    def __init__(self, machine: str, image: Path, *, uarts: int, options: Sequence[str] = ()) -> None:
        command = [qemu(), "-machine", machine, "-kernel", str(image), *options]
        command += ["-display", "none", "-monitor", "none"]
        with socket.create_server(("127.0.0.1", 0)) as server:
            server.settimeout(PATIENCE)
            port = server.getsockname()[1]
            for _ in range(uarts):
                command += ["-serial", f"tcp:127.0.0.1:{port},nodelay=on"]
            self.process = subprocess.Popen(command, stdin=subprocess.DEVNULL)
            self.lines = [server.accept()[0] for _ in range(uarts)]  # QEMU connects them in their order
        for line in self.lines:
            line.settimeout(PATIENCE)
            line.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)

    def __enter__(self) -> Board:
        return self

    def __exit__(self, *_: object) -> None:
        self.process.kill()
        self.process.wait()
        for line in self.lines:
            line.close()


def receive(line: socket.socket, size: int) -> bytes:
    """Exactly ``size`` bytes."""
    data = b""
    while len(data) < size:
        piece = line.recv(size - len(data))
        assert piece, "QEMU has ended"
        data += piece
    return data
