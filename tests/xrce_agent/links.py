# SPDX-License-Identifier: Apache-2.0
"""How an agent is reached: UDP, or a serial line, which is a pseudo terminal or a device that is there already."""

from __future__ import annotations

import contextlib
import errno
import os
import random
import socket
import termios
import time
import tty
from collections.abc import Hashable
from pathlib import Path
from typing import Protocol

from .framing import AGENT, Deframer, frame

READ = 65536
PATIENCE = 2.0
"""Seconds for a port to become free."""


class Link(Protocol):
    """Frames to and from peers.  ``open`` and ``close`` may be called again and again; the address stays the same."""

    def open(self) -> None: ...

    def close(self) -> None: ...

    def fileno(self) -> int:
        """To wait for; -1 while it is closed."""

    def receive(self) -> list[tuple[Hashable, bytes]]:
        """Frames that are there, with who sent them."""

    @property
    def checked(self) -> bool:
        """Whether a damaged frame is seen to be one."""

    def raw(self, peer: Hashable, data: bytes) -> bytes:
        """The bytes that carry a message: the datagram, or its frame on the line."""

    def send_raw(self, peer: Hashable, data: bytes) -> None:
        """Such bytes, or any."""


class UdpLink:
    """A port of the loopback interface; 0 takes a free one.

    It is none of those that the system gives to sockets which ask for any: closed for a moment, it would be taken.
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
        end = time.monotonic() + PATIENCE
        while self._socket is None:
            try:
                self._bind()
            except OSError:
                # A thread that was waiting for the old socket holds it for a moment still.
                if time.monotonic() > end:
                    raise
                time.sleep(0.001)

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
            except ConnectionError:  # a board that is gone has answered so
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
    """What pseudo terminals and devices have in common; peers are addresses on the line, of which there is one."""

    checked = True

    def __init__(self) -> None:
        self._file = -1
        self._deframer = Deframer()

    @property
    def broken(self) -> int:
        """Frames that were none."""
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
            data = b""
        if not data:
            self._nobody()
        return [*self._deframer.feed(data)]

    def _nobody(self) -> None:
        """Nothing is at the other end."""

    def raw(self, peer: Hashable, data: bytes) -> bytes:
        assert isinstance(peer, int)
        return frame(data, AGENT, peer)

    def send_raw(self, peer: Hashable, data: bytes) -> None:
        """What does not fit is lost, as on a line."""
        with contextlib.suppress(OSError):
            if self._file >= 0:
                os.write(self._file, data)

    def close(self) -> None:
        if self._file >= 0:
            os.close(self._file)
            self._file = -1
        self._deframer = Deframer()


class PtyLink(SerialLink):
    """A pseudo terminal whose other end has a name: ``--serial-device <path>``.  Closed, the name is gone."""

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
        """As a cable that is pulled: the board's end hangs up."""
        if self._other >= 0:
            os.close(self._other)
            self._other = -1
            self.path.unlink(missing_ok=True)
        super().close()


class DeviceLink(SerialLink):
    """A terminal that a board or an emulator has made, opened whenever it is there."""

    def __init__(self, path: Path, baud: int = termios.B115200) -> None:
        super().__init__()
        self.path, self._baud = path, baud

    @property
    def address(self) -> str:
        return str(self.path)

    def open(self) -> None:
        if self._file >= 0:
            return
        try:
            self._file = os.open(self.path, os.O_RDWR | os.O_NOCTTY | os.O_NONBLOCK)
        except OSError:
            return  # it is not there (yet): the agent tries again
        tty.setraw(self._file)
        settings = termios.tcgetattr(self._file)
        settings[4] = settings[5] = self._baud
        termios.tcsetattr(self._file, termios.TCSANOW, settings)

    def _nobody(self) -> None:
        self.close()
