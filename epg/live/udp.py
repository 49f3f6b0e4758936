# SPDX-License-Identifier: Apache-2.0
"""The console of a program on another computer, by UDP: a port like a serial one, over datagrams that can be lost.

A datagram is a header and whole frames.  Commands are sent again until the target has them; their numbers let each act
once.  The target does the same with lines of answers.  ``docs/live.md`` describes the datagrams.

>>> parse("udp:192.168.1.10:7000"), parse("udp:[::1]:7000"), parse("udp:7000")
(('192.168.1.10', 7000), ('::1', 7000), ('127.0.0.1', 7000))
"""

from __future__ import annotations

import contextlib
import os
import re
import select
import socket
import struct
import threading
import time
from dataclasses import dataclass
from pathlib import PurePath
from types import TracebackType

from epg.live.frames import decode, encode
from epg.live.port import PortError

PREFIX = "udp:"
AGAIN = 0.05
"""Seconds after which a datagram without an answer is sent again."""
PATIENCE = 1.0
"""Seconds after which a command that did not arrive must not act any more."""
GONE = 2.5
"""Seconds without a datagram after which the target is gone.  It gives up a program after 2 s."""
BUFFER = 4 << 20
"""Bytes of datagrams that may wait while this program is busy."""

_HEADER = struct.Struct("<4sBIIII")
_MAGIC = b"\x01EPG"
_BEGIN, _END, _DISABLE = 1, 2, 4
_RUNNING, _OVER, _DISABLED, _TAKEN, _ONCE = 1, 2, 4, 8, 16
_BITS = 32
_MODULO = 1 << 32


class PortTaken(PortError):
    """Another program uses the target."""


def is_udp(path: PurePath) -> bool:
    """True if ``path`` is the name of a port by UDP."""
    return str(path).startswith(PREFIX)


def parse(name: str) -> tuple[str, int]:
    """Host and port of ``udp:[HOST:]PORT``.

    :raises PortError: it does not have this form
    """
    found = re.fullmatch(r"udp:(?:(?:\[([^\]]+)\]|([^:/\[\]]+)):)?(\d{1,5})", name, re.ASCII)
    if found is None or not 0 < int(found[3]) < 65536:
        raise PortError(
            f"'{name}' is not udp:HOST:PORT", "for example udp:192.168.1.10:7000, udp:[::1]:7000 or udp:robot:7000"
        )
    return found[1] or found[2] or "127.0.0.1", int(found[3])


@dataclass
class _Command:
    """A command that the target has not confirmed."""

    frame: bytes
    flags: int
    until: float
    due: float


class UdpPort:
    """An open connection with a target.

    :raises PortTaken: another program uses the target
    :raises PortError: the target does not answer
    """

    def __init__(self, path: PurePath) -> None:
        self.path = path
        self._socket = _connected(str(path))
        self._session = _session()
        self._lock = threading.Lock()
        self._number = 0  # of the newest command
        self._lowest = 0  # commands with a lower number must not act any more
        self._commands: dict[int, _Command] = {}
        self._line = 0  # number of the next line
        self._once = 0  # number of the newest datagram with frames that are sent once
        self._confirm = False
        self._arrived: list[bytes] = []
        self._running = False
        self._taken = ""
        try:
            self._begin()
        except BaseException:
            self._socket.close()
            raise

    def read(self, seconds: float) -> bytes:
        """The frames that arrive within ``seconds``; returns as soon as there are some.

        :raises PortError: the target is gone
        """
        end = time.monotonic() + seconds
        while True:
            self._receive()
            now = time.monotonic()
            with self._lock:
                self._send_again(now)
                if self._confirm:
                    self._send(0, 0, b"")
                arrived, self._arrived = self._arrived, []
            if arrived or now >= end:
                return b"".join(arrived)
            if now - self._heard > GONE:
                raise PortError(f"{self.path} does not answer any more", "look at the network and at the program")
            select.select([self._socket], [], [], min(end - now, AGAIN))

    def write(self, data: bytes) -> None:
        """Sends a frame.  A command is sent again by :meth:`read` until the target has it.

        :raises PortError: the target is gone
        """
        message = decode(data.strip(b"\0")) or b""
        now = time.monotonic()
        with self._lock:
            if message[:1] not in (b"C", b"S"):
                self._send(0, 0, data)
                return
            self._number += 1
            flags = 0
            if message[:1] == b"C" and message[2:].split()[:1] == [b"disable"]:
                flags = _DISABLE
                self._overtake()
            self._send(flags, self._number, data)
            if message[1:2] != b"\0":
                self._commands[self._number] = _Command(data, flags, now + PATIENCE, now + AGAIN)

    def close(self) -> None:
        """Leaves the target to others."""
        with contextlib.suppress(OSError, PortError):
            for _ in range(3):  # one of them arrives, as a rule; if not, the target notices the silence
                self._send(_END, 0, b"")
        self._socket.close()

    def __enter__(self) -> UdpPort:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, value: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def _begin(self) -> None:
        """Asks for the target until it answers."""
        begin = self._heard = time.monotonic()
        while not self._running:
            if time.monotonic() > begin + GONE:
                if self._taken:
                    raise PortTaken(
                        f"another program has {self.path}: {self._taken}",
                        f"end it; 'epg live {self.path} --send disable' disables the target all the same",
                    )
                raise PortError(
                    f"nothing answers at {self.path}",
                    "look at the address and the firewall; a program listens with --console-udp",
                )
            self._send(_BEGIN, 0, b"")
            select.select([self._socket], [], [], AGAIN)
            self._receive()
            if self._taken and not self._running:
                time.sleep(AGAIN)

    def _send(self, flags: int, number: int, body: bytes) -> None:
        """Sends a datagram.  One that the system cannot take is lost, as others are."""
        header = _HEADER.pack(_MAGIC, flags, self._session, number, self._line, self._lowest)
        self._confirm = False
        try:
            self._socket.send(header + body)
        except ConnectionRefusedError as error:
            raise self._gone() from error
        except OSError:
            pass

    def _gone(self) -> PortError:
        if self._running:
            return PortError(f"{self.path} is gone", "look at the program, and connect again")
        return PortError(f"no program has {self.path}", "a host program has it with --console-udp [ADDRESS:]PORT")

    def _overtake(self) -> None:
        """Drops the commands before a `disable`: they must not act after it.  Their answer is that they did not."""
        self._lowest = self._number
        for command in self._commands.values():
            message = decode(command.frame.strip(b"\0")) or b"C\0"
            self._arrived.append(encode(b"A" + message[1:2] + b"error command was overtaken by 'disable'"))
        self._commands.clear()

    def _send_again(self, now: float) -> None:
        for number, command in list(self._commands.items()):
            if now > command.until:
                self._lowest = max(self._lowest, number + 1)
                del self._commands[number]
            elif now >= command.due:
                command.due = now + AGAIN
                self._send(command.flags, number, command.frame)

    def _receive(self) -> None:
        """Takes the datagrams that have arrived."""
        while True:
            try:
                data = self._socket.recv(65536)
            except BlockingIOError:
                return
            except ConnectionRefusedError as error:
                raise self._gone() from error
            except OSError as error:
                if self._running:
                    return  # the network can come back
                raise PortError(f"{self.path}: {error.strerror}", "look at the address and the network") from error
            with self._lock:
                self._take(data)

    def _take(self, data: bytes) -> None:
        if len(data) < _HEADER.size:
            return
        magic, flags, session, number, newest, seen = _HEADER.unpack_from(data)
        if magic != _MAGIC or session != self._session:
            return
        self._heard = time.monotonic()
        body = data[_HEADER.size :]
        if flags & _TAKEN:
            self._taken = body.decode("ascii", "replace")
        if flags & _OVER:
            raise PortError(f"the program has closed {self.path}", "connect again")
        if not flags & _RUNNING:
            return
        self._running = True
        for sent in list(self._commands):
            if sent == newest or (0 < newest - sent <= _BITS and seen >> (newest - sent - 1) & 1):
                del self._commands[sent]
        frames = [b"\0" + part + b"\0" for part in body.split(b"\0") if part]
        if flags & _ONCE:
            if number > self._once:
                self._once = number
                self._arrived += frames
        elif frames:
            self._confirm = True
            fresh = (self._line - number) % _MODULO
            if fresh < len(frames):
                self._arrived += frames[fresh:]
                self._line += len(frames) - fresh


def disable(path: PurePath) -> None:
    """Disables the target, also while another program uses it.

    :raises PortError: the target does not answer
    """
    session = _session()
    end = time.monotonic() + GONE
    with _connected(str(path)) as connected:
        while time.monotonic() < end:
            with contextlib.suppress(OSError):
                connected.send(_HEADER.pack(_MAGIC, _DISABLE, session, 0, 0, 0))
                if select.select([connected], [], [], AGAIN)[0]:
                    data = connected.recv(65536)
                    if len(data) >= _HEADER.size:
                        magic, flags, answered = _HEADER.unpack_from(data)[:3]
                        if magic == _MAGIC and answered == session and flags & _DISABLED:
                            return
    raise PortError(f"nothing answers at {path}", "switch the actuators' supply off")


def _connected(name: str) -> socket.socket:
    """A socket that talks to the address ``name`` only."""
    host, port = parse(name)
    try:
        kind, protocol, address = next(
            (family, protocol, address)
            for family, _, protocol, _, address in socket.getaddrinfo(host, port, type=socket.SOCK_DGRAM)
        )
    except (OSError, UnicodeError) as error:
        raise PortError(f"the host '{host}' was not found", "look at its name and at the network") from error
    result = socket.socket(kind, socket.SOCK_DGRAM, protocol)
    try:
        result.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, BUFFER)
        result.setblocking(False)
        result.connect(address)
    except OSError as error:
        result.close()
        raise PortError(f"{name} cannot be reached: {error.strerror}", "look at the network") from error
    return result


def _session() -> int:
    return int.from_bytes(os.urandom(4), "little") or 1
