# SPDX-License-Identifier: Apache-2.0
"""Windows."""

from __future__ import annotations

import os
import signal
import time
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from functools import cache
from pathlib import Path
from typing import Any

_CTRL_C, _CTRL_BREAK = 0, 1
NAME = "windows"
_SIGBREAK = getattr(signal, "SIGBREAK", signal.SIGTERM)
NOT_IN_PROJECTS = "[#<>?]"
SHARES_PORTS = False  # another program could then take over the port
HAS_TERMINALS = False
LOCKS_PROGRAMS = True
_SUSPENDED, _NEW_GROUP, _BELOW_NORMAL = 0x4, 0x200, 0x4000
_ACCOUNTING, _LIMITS, _KILL_ON_CLOSE = 1, 9, 0x2000  # JOBOBJECTINFOCLASS; JOB_OBJECT_LIMIT_KILL_ON_JOB_CLOSE
_LIMITS_SIZE, _LIMIT_FLAGS = 144, 16  # of JOBOBJECT_EXTENDED_LIMIT_INFORMATION on 64 bit, in bytes
_ACCOUNTING_SIZE, _ACTIVE = 48, 40  # of JOBOBJECT_BASIC_ACCOUNTING_INFORMATION
_REMOVABLE, _NO_DIALOGS = 2, 1
_ATTACHED_OF_BUS = 0x101  # CM_GETIDLIST_FILTER_ENUMERATOR, CM_GETIDLIST_FILTER_PRESENT
_LONGEST_END = 30  # seconds; Windows ends the program after 5 s to 20 s
_kept: list[object] = []  # functions that Windows calls


def caches() -> Path:
    base = os.environ.get("LOCALAPPDATA")
    return Path(base) if base else Path.home() / ".cache"


def settings() -> Path:
    base = os.environ.get("APPDATA")
    return Path(base) if base else Path.home() / ".config"


def own_users() -> set[int]:
    return set()


def access_problem(folder: Path) -> str:
    return ""  # a folder of the user is always private


def all_may_write(mode: int) -> bool:
    return False


def is_administrator() -> bool:
    return False


def has_screen() -> bool:
    return True


def lock(file: int) -> None:
    """Windows refuses to remove an open file."""


@contextmanager
def held(path: Path) -> Iterator[None]:
    yield


def quoted(command: Sequence[str]) -> str:
    import subprocess

    return subprocess.list2cmdline(command)


def _on_event(event: int) -> bool:
    """Called in a thread of Windows, which ends this program after the return, but for Ctrl-C and Ctrl-Break."""
    if event == _CTRL_C or signal.getsignal(_SIGBREAK) == signal.SIG_DFL:
        return False  # to Python's own handler
    signal.raise_signal(_SIGBREAK)
    if event != _CTRL_BREAK:
        time.sleep(_LONGEST_END)
    return True


@cache
def end_signals() -> tuple[int, ...]:
    """SIGBREAK is also the end of the window and of the user's session, until which this program can then work."""
    import ctypes

    handler = getattr(ctypes, "WINFUNCTYPE")(ctypes.c_int, ctypes.c_uint32)(_on_event)  # noqa: B009
    _library("kernel32").SetConsoleCtrlHandler(handler, True)
    _kept.append(handler)
    return (signal.SIGTERM, _SIGBREAK)


def _library(name: str) -> Any:
    import ctypes

    return getattr(ctypes, "WinDLL")(name, use_last_error=True)  # noqa: B009  # on Linux, the module does not have it


def drives() -> list[Path]:
    """The removable drives with a medium: the others may be slow, and ask the user for a disk."""
    kernel = _library("kernel32")
    kernel.SetErrorMode(_NO_DIALOGS)
    roots = [f"{chr(ord('A') + i)}:\\" for i in range(26) if kernel.GetLogicalDrives() >> i & 1]
    return [
        Path(root)
        for root in roots
        if kernel.GetDriveTypeW(root) == _REMOVABLE
        and kernel.GetVolumeInformationW(root, None, 0, None, None, None, None, 0)
    ]


def usb_devices() -> list[str] | None:
    import ctypes

    manager, size = _library("cfgmgr32"), ctypes.c_uint32()
    if manager.CM_Get_Device_ID_List_SizeW(ctypes.byref(size), "USB", _ATTACHED_OF_BUS):
        return None
    names = ctypes.create_unicode_buffer(size.value)
    if manager.CM_Get_Device_ID_ListW("USB", names, size, _ATTACHED_OF_BUS):
        return None
    return [name for name in "".join(names).split("\0") if name]


class WindowsJob:
    """A program in a job, which has all programs that it starts, and those that they start."""

    def __init__(
        self, command: Sequence[str], folder: Path, environment: Mapping[str, str], flags: int, *, bound: bool
    ) -> None:
        import ctypes
        import subprocess

        self._kernel = _library("kernel32")
        self._kernel.CreateJobObjectW.restype = ctypes.c_void_p
        self._job = ctypes.c_void_p(self._kernel.CreateJobObjectW(None, None))
        if bound:  # the end of this program closes the job
            limits = bytearray(_LIMITS_SIZE)
            limits[_LIMIT_FLAGS : _LIMIT_FLAGS + 4] = _KILL_ON_CLOSE.to_bytes(4, "little")
            self._kernel.SetInformationJobObject(self._job, _LIMITS, bytes(limits), _LIMITS_SIZE)
        self.process = subprocess.Popen(
            list(command),
            cwd=folder,
            env=dict(environment),
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            creationflags=flags | _SUSPENDED | _NEW_GROUP,
        )
        handle = ctypes.c_void_p(int(getattr(self.process, "_handle")))  # noqa: B009
        self._kernel.AssignProcessToJobObject(self._job, handle)  # before the program can start another one
        _library("ntdll").NtResumeProcess(handle)

    def ask_to_end(self) -> None:
        try:
            self.process.send_signal(_CTRL_BREAK)
        except OSError:  # EPG has no console
            self.process.terminate()

    def is_running(self) -> bool:
        import ctypes

        found = ctypes.create_string_buffer(_ACCOUNTING_SIZE)
        self._kernel.QueryInformationJobObject(self._job, _ACCOUNTING, found, _ACCOUNTING_SIZE, None)
        return any(found.raw[_ACTIVE : _ACTIVE + 4])

    def kill(self) -> None:
        self._kernel.TerminateJobObject(self._job, 1)

    def __del__(self) -> None:
        self._kernel.CloseHandle(self._job)


def start(
    command: Sequence[str], folder: Path, environment: Mapping[str, str], *, modest: bool, bound: bool
) -> WindowsJob:
    return WindowsJob(command, folder, environment, _BELOW_NORMAL if modest else 0, bound=bound)
