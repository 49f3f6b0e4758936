# SPDX-License-Identifier: Apache-2.0
"""The console of a program on another computer, by UDP: a port like a serial one, over datagrams that can be lost.

A datagram is a header and whole frames.  Commands are sent again until the target has them; their numbers let each act
once.  The target does the same with lines of answers.  ``docs/live-protocol.md`` describes the datagrams.  If this
user has given a key for the port, all datagrams are sealed, and others do not count.

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
from typing import NamedTuple

from epg.live.frames import decode, encode
from epg.live.port import PortError
from epg.live.udp_keys import file_of, kept_key
from epg.live.udp_seal import Seal

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
_RUNNING, _OVER, _DISABLED, _TAKEN, _ONCE, _LOCKED = 1, 2, 4, 8, 16, 64
_BITS = 32
_MODULO = 1 << 32
_REFUSED = (ConnectionRefusedError, ConnectionResetError)  # no program has the port; the latter on Windows


class PortTaken(PortError):
    """Another program uses the target."""


class PortLocked(PortError):
    """The target needs a key, or another one."""


def is_udp(path: PurePath) -> bool:
    """True if ``path`` is the name of a port by UDP."""
    return str(path).startswith(PREFIX)


def parse(name: str) -> tuple[str, int]:
    """Host and port of ``udp:[HOST:]PORT``.

    :raises PortError: it does not have this form
    """
    match = re.fullmatch(r"udp:(?:(?:\[([^\]]+)\]|([^:/\[\]]+)):)?(\d{1,5})", name, re.ASCII)
    if match is None or not 0 < int(match[3]) < 65536:
        raise PortError(
            f"'{name}' is not udp:HOST:PORT", "for example udp:192.168.1.10:7000, udp:[::1]:7000 or udp:robot:7000"
        )
    return match[1] or match[2] or "127.0.0.1", int(match[3])


class _Datagram(NamedTuple):
    """A datagram of the target.  ``newest`` is the newest command that it has, ``seen`` a bit for each earlier one."""

    flags: int
    number: int
    newest: int
    seen: int
    body: bytes


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
    :raises PortLocked: it needs the key that its program has printed
    :raises PortError: the target does not answer
    """

    def __init__(self, path: PurePath) -> None:
        self.path = path
        key = kept_key(path)
        self._seal = Seal(key) if key is not None else None
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
        self._locked = False
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
        with contextlib.suppress(OSError, PortError), self._lock:
            for _ in range(3):  # one of them arrives, as a rule; if not, the target notices the silence
                self._send(_END, 0, b"")
        self._socket.close()

    def __enter__(self) -> UdpPort:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def _begin(self) -> None:
        """Asks for the target until it answers."""
        begin = self._heard = time.monotonic()
        while not self._running:
            if self._locked and self._seal is None:
                raise _locked(self.path, "needs a key")
            if time.monotonic() > begin + GONE:
                if self._locked:  # it did not answer in another way, so the key is wrong
                    raise _locked(self.path, "has another key than the one that was given")
                if self._taken:
                    raise PortTaken(
                        f"another program has {self.path}: {self._taken}",
                        f"end it; 'epg live {self.path} --send disable' disables the target all the same",
                    )
                hint = "look at the address and the firewall; a program listens with --console-udp"
                if self._seal is not None:
                    hint += f"; if the program has no key any more, remove {file_of(self.path)}"
                raise PortError(f"nothing answers at {self.path}", hint)
            self._send(_BEGIN, 0, b"")
            select.select([self._socket], [], [], AGAIN)
            self._receive()
            if (self._taken or self._locked) and not self._running:
                time.sleep(AGAIN)

    def _send(self, flags: int, number: int, body: bytes) -> None:
        """Sends a datagram.  One that the system cannot take is lost, as others are."""
        data = _HEADER.pack(_MAGIC, flags, self._session, number, self._line, self._lowest) + body
        self._confirm = False
        try:
            self._socket.send(self._seal.close(data) if self._seal is not None else data)
        except _REFUSED as error:
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
            except _REFUSED as error:
                raise self._gone() from error
            except OSError as error:
                if self._running:
                    return  # the network can come back
                raise PortError(f"{self.path}: {error.strerror}", "look at the address and the network") from error
            with self._lock:
                self._take(data)

    def _take(self, data: bytes) -> None:
        self._locked = self._locked or _flags(data, self._session) == _LOCKED
        if self._seal is not None:
            opened = self._seal.open(data)
            if opened is None:
                return
            data = opened
        taken = _parsed(data, self._session)
        if taken is None:
            return
        self._heard = time.monotonic()
        if taken.flags & _TAKEN:
            self._taken = taken.body.decode("ascii", "replace")
        if taken.flags & _OVER:
            raise PortError(f"the program has closed {self.path}", "connect again")
        if not taken.flags & _RUNNING:
            return
        self._running = True
        if self._seal is not None:
            self._seal.settled = True
        self._drop_confirmed(taken.newest, taken.seen)
        self._take_frames(taken)

    def _drop_confirmed(self, newest: int, seen: int) -> None:
        """Drops the commands that the target has."""
        for sent in list(self._commands):
            if sent == newest or (0 < newest - sent <= _BITS and seen >> (newest - sent - 1) & 1):
                del self._commands[sent]

    def _take_frames(self, taken: _Datagram) -> None:
        """Takes the frames that have not arrived before."""
        frames = [b"\0" + part + b"\0" for part in taken.body.split(b"\0") if part]
        if taken.flags & _ONCE:
            if taken.number > self._once:
                self._once = taken.number
                self._arrived += frames
        elif frames:
            self._confirm = True
            fresh = (self._line - taken.number) % _MODULO
            if fresh < len(frames):
                self._arrived += frames[fresh:]
                self._line += len(frames) - fresh


def disable(path: PurePath) -> None:
    """Disables the target, also while another program uses it.  The answer says that the target has taken the stop.

    :raises PortError: the target does not answer, or its answer does not prove that it has the key
    """
    session = _session()
    key = kept_key(path)
    seal = Seal(key) if key is not None else None
    end = time.monotonic() + GONE
    unproven = False
    with _connected(str(path)) as connected:
        while time.monotonic() < end:
            with contextlib.suppress(OSError):
                data = _HEADER.pack(_MAGIC, _DISABLE, session, 0, 0, 0)
                connected.send(seal.close(data) if seal is not None else data)
                if select.select([connected], [], [], AGAIN)[0]:
                    answer: bytes | None = connected.recv(65536)
                    if seal is not None and answer is not None:
                        answer = seal.open(answer)
                        unproven = unproven or answer is None
                    if answer is not None and _flags(answer, session) & _DISABLED:
                        return
    if unproven:
        message = f"something answers at {path}, but not with the key that was given for it"
        raise PortError(f"'disable' was sent; {message}", "look at the robot; switch the actuators' supply off")
    raise PortError(f"nothing answers at {path}", "switch the actuators' supply off")


def _parsed(data: bytes, session: int) -> _Datagram | None:
    """A datagram without a seal; None if it is not of this session."""
    if len(data) < _HEADER.size:
        return None
    magic, flags, answered, number, newest, seen = _HEADER.unpack_from(data)
    if magic != _MAGIC or answered != session:
        return None
    return _Datagram(flags, number, newest, seen, data[_HEADER.size :])


def _flags(data: bytes, session: int) -> int:
    """The flags of a datagram without a seal; 0 if it is not of this session."""
    frame = _parsed(data, session)
    return frame.flags if frame is not None else 0


def _locked(path: PurePath, problem: str) -> PortLocked:
    return PortLocked(
        f"{path} {problem}",
        f"its program has printed the key, or has it from --console-key FILE: 'epg live {path}' asks for it in a "
        "terminal, and --key FILE reads it",
    )


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
