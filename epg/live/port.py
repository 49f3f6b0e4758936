# SPDX-License-Identifier: Apache-2.0
"""Serial ports of a target, and the terminal of a host program.

A port belongs to one program at a time.  Others are told which program has it.
"""

from __future__ import annotations

import contextlib
import errno
import os
import select
import stat
import sys
from pathlib import Path

with contextlib.suppress(ImportError):  # Windows does not have them, and `epg connect` must work there
    import fcntl
    import termios
    import tty

BAUD = 115200


class PortError(Exception):
    """A port cannot be used; ``hint`` says how to change that."""

    def __init__(self, message: str, hint: str) -> None:
        super().__init__(message)
        self.hint = hint


class SerialPort:
    """An open serial port or terminal, without echo and without a change of any byte.

    :raises PortError: it does not exist, another program has it, or it is no terminal
    """

    def __init__(self, path: Path, baud: int = BAUD) -> None:
        self.path = path
        if sys.modules.get("termios") is None:
            raise PortError("EPG does not use ports on this system", "start it on Linux")
        try:
            self._file = os.open(path, os.O_RDWR | os.O_NOCTTY | os.O_NONBLOCK | os.O_CLOEXEC)
        except OSError as error:
            raise _error_of_open(path, error) from error
        try:
            self._configure(baud)
        except BaseException:
            os.close(self._file)
            raise

    def _configure(self, baud: int) -> None:
        if not os.isatty(self._file):
            kind = "a folder" if stat.S_ISDIR(os.fstat(self._file).st_mode) else "not a serial port"
            raise PortError(f"{self.path} is {kind}", "name a serial port, such as /dev/ttyACM0")
        try:
            fcntl.flock(self._file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError as error:
            raise _taken(self.path) from error
        fcntl.ioctl(self._file, termios.TIOCEXCL)
        speed = getattr(termios, f"B{baud}", None)
        if speed is None:
            raise PortError(
                f"this computer's serial ports have no rate of {baud}", "use a rate such as 115200 or 921600"
            )
        tty.setraw(self._file, termios.TCSANOW)
        attributes = termios.tcgetattr(self._file)
        attributes[2] |= termios.CLOCAL | termios.CREAD
        attributes[4] = attributes[5] = speed
        termios.tcsetattr(self._file, termios.TCSANOW, attributes)
        termios.tcflush(self._file, termios.TCIFLUSH)

    def read(self, seconds: float) -> bytes:
        """The bytes that arrive within ``seconds``; returns as soon as there are some.

        :raises PortError: the port is gone
        """
        if not select.select([self._file], [], [], seconds)[0]:
            return b""
        try:
            data = os.read(self._file, 65536)
        except BlockingIOError:
            return b""
        except OSError as error:
            raise self._gone() from error
        if not data:
            raise self._gone()
        return data

    def write(self, data: bytes, seconds: float = 1.0) -> None:
        """Writes ``data``.

        :raises PortError: the port is gone, or took no byte for ``seconds``
        """
        while data:
            if not select.select([], [self._file], [], seconds)[1]:
                raise PortError(f"{self.path} takes no bytes", "look at the cable; reset the board")
            try:
                data = data[os.write(self._file, data) :]
            except BlockingIOError:
                continue
            except OSError as error:
                raise self._gone() from error

    def close(self) -> None:
        os.close(self._file)

    def _gone(self) -> PortError:
        return PortError(f"{self.path} is gone", "look at the cable and at the program, and connect again")

    def __enter__(self) -> SerialPort:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()


def _error_of_open(path: Path, error: OSError) -> PortError:
    if error.errno == errno.ENOENT:
        return PortError(f"there is no {path}", "look at the cable, and at 'epg live', which lists the ports")
    if error.errno == errno.EACCES:
        return PortError(
            f"you must not use {path}", "add yourself to its group: sudo usermod -aG dialout $USER, then log in again"
        )
    if error.errno == errno.EBUSY:
        return _taken(path)
    return PortError(f"{path} cannot be opened: {error.strerror}", "name a serial port, such as /dev/ttyACM0")


def _taken(path: Path) -> PortError:
    user = program_with(path)
    return PortError(f"another program has {path}{f': {user}' if user else ''}", "end it, or use it")


def program_with(path: Path) -> str:
    """Name and process of a program that has ``path`` open, as far as this user can see; else empty."""
    device = path.resolve()
    for folder in Path("/proc").glob("[0-9]*"):
        if folder.name == str(os.getpid()):
            continue
        try:
            if any(Path(os.readlink(file)) == device for file in (folder / "fd").iterdir()):
                return f"{(folder / 'comm').read_text().strip()} (process {folder.name})"
        except OSError:
            continue
    return ""
