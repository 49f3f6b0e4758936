# SPDX-License-Identifier: Apache-2.0
"""The serial ports of Windows: ``COM3`` or ``\\\\.\\COM12``.

Reads and writes are overlapped: of a port that was opened without that, Windows lets a write wait for a read.
"""

from __future__ import annotations

import ctypes
import importlib
import re
import threading
from collections.abc import Callable, Iterator
from ctypes import byref, c_char, c_uint8, c_uint16, c_uint32, c_void_p
from pathlib import Path, PurePath
from typing import Any

from epg.live.ports import PortError, UsbPort, full, gone, missing, wrong_rate
from epg.live.ports.registry import ports_of

_READ_AND_WRITE, _OPEN_EXISTING, _OVERLAPPED = 0xC0000000, 3, 0x40000000
_NOT_FOUND, _NO_PATH, _DENIED, _SHARED, _WRONG_PARAMETER, _PENDING = 2, 3, 5, 32, 87, 997
_TIMED_OUT = (121, 258, 1460)
_BINARY, _DTR, _RTS = 0x1, 0x10, 0x1000  # a USB device takes DTR for an open port
_PURGE_INPUT = 0x8
_INVALID = c_void_p(-1).value
_BUFFER = 65536
_IN_USE = "close the other programs that can have it: a terminal, an IDE, a page of 'epg connect', another 'epg live'"


class _State(ctypes.Structure):
    """DCB"""

    _fields_ = (
        *((name, c_uint32) for name in ("size", "baud", "flags")),
        *((name, c_uint16) for name in ("reserved", "xon", "xoff")),
        *((name, c_uint8) for name in ("bits", "parity", "stop_bits")),
        *((name, c_char) for name in ("xon_char", "xoff_char", "error_char", "end_char", "event_char")),
        ("reserved_1", c_uint16),
    )


class _Times(ctypes.Structure):
    """COMMTIMEOUTS, in milliseconds"""

    _fields_ = tuple(
        (name, c_uint32) for name in ("read_gap", "read_factor", "read_most", "write_factor", "write_most")
    )


class _Queues(ctypes.Structure):
    """COMSTAT"""

    _fields_ = (("flags", c_uint32), ("input", c_uint32), ("output", c_uint32))


class _Overlapped(ctypes.Structure):
    _fields_ = (
        *(("internal", c_void_p), ("internal_high", c_void_p)),
        *(("offset", c_uint32), ("offset_high", c_uint32), ("event", c_void_p)),
    )


class ComPort:
    """An open port.  One thread may read; any may write."""

    def __init__(self, path: PurePath, baud: int, kernel: Any = None) -> None:
        self._path = Path(path)
        self._kernel = kernel if kernel is not None else _load_kernel()
        self._writing = threading.Lock()
        self._wait = -1
        name = com_name(path)
        if not name:
            raise PortError(f"{path} is not a serial port", "name a serial port, such as COM3")
        self._file = self._kernel.CreateFileW(
            rf"\\.\{name}", _READ_AND_WRITE, 0, None, _OPEN_EXISTING, _OVERLAPPED, None
        )
        if self._file in (None, _INVALID):
            raise _error_of_open(self._path, self._kernel.error())
        self._events = [self._kernel.CreateEventW(None, True, False, None) for _ in range(2)]
        try:
            self._configure(baud)
        except BaseException:
            self.close()
            raise

    def _configure(self, baud: int) -> None:
        state = _State(size=ctypes.sizeof(_State))
        self._check(self._kernel.GetCommState(self._file, byref(state)))
        state.baud, state.flags, state.bits = baud, _BINARY | _DTR | _RTS, 8
        state.parity = state.stop_bits = 0
        if not self._kernel.SetCommState(self._file, byref(state)):
            raise wrong_rate(baud) if self._kernel.error() == _WRONG_PARAMETER else gone(self._path)
        self._kernel.SetupComm(self._file, _BUFFER, _BUFFER)
        self._kernel.PurgeComm(self._file, _PURGE_INPUT)

    def read(self, seconds: float) -> bytes:
        milliseconds = max(1, round(seconds * 1000))
        if milliseconds != self._wait:
            times = _Times(0, 0, milliseconds, 0, 1000)
            self._check(self._kernel.SetCommTimeouts(self._file, byref(times)))
            self._wait = milliseconds
        data = b"" if self._waiting() else self._read(1)
        return data + self._read(self._waiting())

    def _waiting(self) -> int:
        """The number of bytes that have arrived."""
        errors, queues = c_uint32(), _Queues()
        self._check(self._kernel.ClearCommError(self._file, byref(errors), byref(queues)))
        return int(queues.input)

    def _read(self, most: int) -> bytes:
        if most == 0:
            return b""
        buffer = ctypes.create_string_buffer(most)
        count = self._transfer(self._kernel.ReadFile, buffer, most, self._events[0])
        return ctypes.string_at(buffer, count)

    def write(self, data: bytes, seconds: float) -> None:
        """``seconds`` is always 1 s."""
        with self._writing:
            while data:
                count = self._transfer(self._kernel.WriteFile, data, len(data), self._events[1])
                if count == 0:
                    raise full(self._path)
                data = data[count:]

    def close(self) -> None:
        for handle in (self._file, *self._events):
            self._kernel.CloseHandle(handle)

    def _transfer(self, function: Callable[..., int], data: Any, size: int, event: int) -> int:
        """Reads or writes, and returns the number of bytes.  The port's times end it."""
        state, count = _Overlapped(event=event), c_uint32()
        if not function(self._file, data, size, None, byref(state)) and self._kernel.error() != _PENDING:
            raise gone(self._path)
        done = self._kernel.GetOverlappedResult(self._file, byref(state), byref(count), True)
        if not done and self._kernel.error() not in _TIMED_OUT:
            raise gone(self._path)  # Windows takes the end of the time for a success, Wine does not
        return count.value

    def _check(self, done: int) -> None:
        if not done:
            raise gone(self._path)


def _load_kernel() -> Any:
    kernel: Any = ctypes.CDLL("kernel32", use_last_error=True)
    kernel.error = ctypes.get_last_error  # type: ignore[attr-defined]
    kernel.CreateFileW.restype = kernel.CreateEventW.restype = c_void_p
    kernel.CreateFileW.argtypes = (ctypes.c_wchar_p, c_uint32, c_uint32, c_void_p, c_uint32, c_uint32, c_void_p)
    kernel.CreateEventW.argtypes = (c_void_p, c_uint32, c_uint32, ctypes.c_wchar_p)
    kernel.ReadFile.argtypes = kernel.WriteFile.argtypes = (c_void_p, c_void_p, c_uint32, c_void_p, c_void_p)
    kernel.GetOverlappedResult.argtypes = (c_void_p, c_void_p, c_void_p, c_uint32)
    for name in ("GetCommState", "SetCommState", "SetCommTimeouts"):
        getattr(kernel, name).argtypes = (c_void_p, c_void_p)
    kernel.ClearCommError.argtypes = (c_void_p, c_void_p, c_void_p)
    kernel.SetupComm.argtypes = (c_void_p, c_uint32, c_uint32)
    kernel.PurgeComm.argtypes = (c_void_p, c_uint32)
    kernel.CloseHandle.argtypes = (c_void_p,)
    return kernel


def com_name(path: PurePath) -> str:
    r"""``COM12`` of ``COM12`` or ``\\.\COM12``; empty for other paths."""
    found = re.fullmatch(r"(?:[\\/]{2}[.?][\\/])?(COM[1-9][0-9]{0,2})[\\/:]?", str(path), re.IGNORECASE | re.ASCII)
    return found[1].upper() if found else ""


def _error_of_open(path: Path, error: int) -> PortError:
    if error in (_NOT_FOUND, _NO_PATH):
        return missing(path)
    if error in (_DENIED, _SHARED):
        return PortError(f"another program has {path}", _IN_USE)
    return PortError(f"{path} cannot be opened: error {error} of Windows", "name a serial port, such as COM3")


def open_device(path: Path, baud: int) -> ComPort:
    return ComPort(path, baud)


def program_with(path: Path) -> str:
    """Empty: Windows does not tell it."""
    return ""


def list_ports() -> Iterator[UsbPort]:
    return ports_of(importlib.import_module("winreg"))


def usb_port(path: Path) -> UsbPort:
    name = com_name(path)
    return next((port for port in list_ports() if str(port.path) == name), UsbPort(path))
