# SPDX-License-Identifier: Apache-2.0
"""Links to an agent: UDP, or a serial line, which is a pseudo terminal."""

from __future__ import annotations

import contextlib
import errno
import os
import random
import socket
import tty
from collections.abc import Hashable
from pathlib import Path
from typing import Protocol

from tests.doubles.waiting import until

from .framing import AGENT, Deframer, frame

READ = 65536
"""Seconds to wait until a port is free."""


class Link(Protocol):
    """Frames to and from peers.  ``open`` and ``close`` can be called repeatedly; the address does not change."""

    def open(self) -> None: ...

    def close(self) -> None: ...

    def fileno(self) -> int:
        """The file descriptor to wait for; -1 while the link is closed."""

    def receive(self) -> list[tuple[Hashable, bytes]]:
        """The frames that have arrived, each with its sender."""

    @property
    def checked(self) -> bool:
        """True if the receiver detects a damaged frame."""

    def raw(self, peer: Hashable, data: bytes) -> bytes:
        """The bytes that carry a message: the datagram, or its frame on the line."""

    def send_raw(self, peer: Hashable, data: bytes) -> None:
        """Sends such bytes, or any other bytes."""


class UdpLink:
    """A port of the loopback interface; 0 selects a free one.

    The port is outside the range from which the system chooses free ports.  Otherwise another socket could get it while
    this link is closed.
    """

    def __init__(self, port: int = 0, host: str = "127.0.0.1") -> None:
        self.host, self.port = host, port
        self._socket: socket.socket | None = None
        while self.port == 0:
            self.port = random.SystemRandom().randrange(15000, 32000)
            try:
                self._bind()
            except OSError:
                self.port = 0

    checked = False

    @property
    def address(self) -> str:
        return f"{self.host}:{self.port}"

    def open(self) -> None:
        # A thread that waited for the old socket still holds it for a moment.
        until(lambda: self._socket is not None or self._bound(), "the port stays in use", pause=0.001)

    def _bound(self) -> bool:
        with contextlib.suppress(OSError):
            self._bind()
        return self._socket is not None

    def _bind(self) -> None:
        new = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        new.setblocking(False)
        try:
            new.bind((self.host, self.port))
        except OSError:
            new.close()
            raise
        self._socket = new

    def close(self) -> None:
        if self._socket is not None:
            self._socket.close()
            self._socket = None

    def fileno(self) -> int:
        return -1 if self._socket is None else self._socket.fileno()

    def receive(self) -> list[tuple[Hashable, bytes]]:
        frames: list[tuple[Hashable, bytes]] = []
        while self._socket is not None and len(frames) < 100:
            try:
                data, peer = self._socket.recvfrom(READ)
            except BlockingIOError:
                break
            except ConnectionError:  # the port of a board that has ended
                continue
            frames.append((peer, data))
        return frames

    def raw(self, peer: Hashable, data: bytes) -> bytes:
        return data

    def send_raw(self, peer: Hashable, data: bytes) -> None:
        if self._socket is not None:
            with contextlib.suppress(OSError):
                self._socket.sendto(data, peer)  # type: ignore[call-overload]


class SerialLink:
    """The common part of serial lines.  Peers are addresses on the line; there is only one."""

    checked = True

    def __init__(self) -> None:
        self._file = -1
        self._deframer = Deframer()

    @property
    def broken(self) -> int:
        """Number of frames that were not valid."""
        return self._deframer.broken

    def fileno(self) -> int:
        return self._file

    def receive(self) -> list[tuple[Hashable, bytes]]:
        try:
            data = os.read(self._file, READ)
        except BlockingIOError:
            return []
        except OSError as error:
            if error.errno != errno.EIO:
                raise
            data = b""  # no program is at the other end
        return [*self._deframer.feed(data)]

    def raw(self, peer: Hashable, data: bytes) -> bytes:
        assert isinstance(peer, int)
        return frame(data, AGENT, peer)

    def send_raw(self, peer: Hashable, data: bytes) -> None:
        """Sends bytes.  Bytes that do not fit are lost, as on a serial line."""
        with contextlib.suppress(OSError):
            if self._file >= 0:
                os.write(self._file, data)

    def close(self) -> None:
        if self._file >= 0:
            os.close(self._file)
            self._file = -1
        self._deframer = Deframer()


class PtyLink(SerialLink):
    """A pseudo terminal whose other end has a path, ``--serial-device <path>``, while it is open."""

    def __init__(self, path: Path) -> None:
        super().__init__()
        self.path = path
        self._other = -1

    @property
    def address(self) -> str:
        return str(self.path)

    def open(self) -> None:
        if self._file >= 0:
            return
        self._file, self._other = os.openpty()
        tty.setraw(self._other)
        os.set_blocking(self._file, False)
        self.path.unlink(missing_ok=True)
        self.path.symlink_to(os.ttyname(self._other))

    def close(self) -> None:
        """Closes the terminal, like a pulled cable: the board's end hangs up."""
        if self._other >= 0:
            os.close(self._other)
            self._other = -1
            self.path.unlink(missing_ok=True)
        super().close()
