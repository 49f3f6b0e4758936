# SPDX-License-Identifier: Apache-2.0
"""Serial ports and terminals of Linux and macOS."""

from __future__ import annotations

import errno
import fcntl
import os
import select
import stat
import termios
import tty
from collections.abc import Callable
from pathlib import Path
from typing import Any

from epg.generator.install import remedy
from epg.live.ports import PortError, full, gone, missing, wrong_rate

_PSEUDO_TERMINALS = ("/dev/pts/", "/dev/ttys")  # of Linux and macOS


class PosixPort:
    """An open terminal.  Messages name an ``example`` of a port, and the program that has this one, by ``user_of``."""

    def __init__(self, path: Path, baud: int, user_of: Callable[[Path], str], example: str) -> None:
        self._path, self._user_of, self._example = path, user_of, example
        try:
            self._file = os.open(path, os.O_RDWR | os.O_NOCTTY | os.O_NONBLOCK | os.O_CLOEXEC)
        except OSError as error:
            raise self._error_of_open(error) from error
        try:
            self._configure(baud)
        except BaseException:
            os.close(self._file)
            raise

    def _configure(self, baud: int) -> None:
        if not os.isatty(self._file):
            kind = "a folder" if stat.S_ISDIR(os.fstat(self._file).st_mode) else "not a serial port"
            raise PortError(f"{self._path} is {kind}", f"name a serial port, such as {self._example}")
        try:
            fcntl.flock(self._file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError as error:
            raise self._taken() from error
        if not os.path.realpath(self._path).startswith(_PSEUDO_TERMINALS):  # they keep this claim
            fcntl.ioctl(self._file, termios.TIOCEXCL)
        tty.setraw(self._file, termios.TCSANOW)
        attributes = termios.tcgetattr(self._file)
        attributes[2] |= termios.CLOCAL | termios.CREAD
        self._set(attributes, baud)
        termios.tcflush(self._file, termios.TCIFLUSH)

    def _set(self, attributes: list[Any], baud: int) -> None:
        speed = getattr(termios, f"B{baud}", None)
        if speed is None:
            raise wrong_rate(baud)
        attributes[4] = attributes[5] = speed
        termios.tcsetattr(self._file, termios.TCSANOW, attributes)

    def read(self, seconds: float) -> bytes:
        if not select.select([self._file], [], [], seconds)[0]:
            return b""
        try:
            data = os.read(self._file, 65536)
        except BlockingIOError:
            return b""
        except OSError as error:
            raise gone(self._path) from error
        if not data:
            raise gone(self._path)
        return data

    def write(self, data: bytes, seconds: float) -> None:
        while data:
            if not select.select([], [self._file], [], seconds)[1]:
                raise full(self._path)
            try:
                data = data[os.write(self._file, data) :]
            except BlockingIOError:
                continue
            except OSError as error:
                raise gone(self._path) from error

    def close(self) -> None:
        os.close(self._file)

    def _error_of_open(self, error: OSError) -> PortError:
        path = self._path
        if error.errno == errno.ENOENT:
            return missing(path)
        if error.errno == errno.EACCES:
            return PortError(f"you must not use {path}", remedy("port access"))
        if error.errno == errno.EBUSY:
            return self._taken()
        return PortError(f"{path} cannot be opened: {error.strerror}", f"name a serial port, such as {self._example}")

    def _taken(self) -> PortError:
        user = self._user_of(self._path)
        return PortError(f"another program has {self._path}{f': {user}' if user else ''}", "end it, or use it")
