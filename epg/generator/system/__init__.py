# SPDX-License-Identifier: Apache-2.0
"""The system on which EPG runs.  A module has the name of its system, ``os.name``, and the members of
:class:`OperatingSystem`.

Only these modules, and those of ``epg/live`` for ports and keyboards, may ask which system it is: tests/docs looks.
"""

from __future__ import annotations

import importlib
import os
from collections.abc import Mapping, Sequence
from contextlib import AbstractContextManager
from pathlib import Path
from typing import TYPE_CHECKING, Protocol, cast

if TYPE_CHECKING:
    import subprocess


class Group(Protocol):
    """A program that was started, and all programs that it starts.

    ``is_running`` is True while one of them runs, as far as the system tells it.  ``kill`` ends all of them now.
    """

    process: subprocess.Popen[bytes]

    def ask_to_end(self) -> None: ...
    def is_running(self) -> bool: ...
    def kill(self) -> None: ...


class OperatingSystem(Protocol):
    """A path with ``NOT_IN_PROJECTS`` is not that of a project.

    ``SHARES_PORTS``: the option SO_REUSEADDR only lets a program have a port again at once.

    ``LOCKS_PROGRAMS``: the file of a program that runs cannot be replaced.
    """

    NAME: str
    """"linux", "macos" or "windows"."""
    NOT_IN_PROJECTS: str
    SHARES_PORTS: bool
    HAS_TERMINALS: bool
    LOCKS_PROGRAMS: bool

    def caches(self) -> Path:
        """The folder for caches of all programs of the user."""
        ...

    def settings(self) -> Path:
        """The folder for settings of all programs of the user."""
        ...

    def own_users(self) -> set[int]:
        """The numbers of this user, of the superuser, and of the user of sudo; empty where users have none."""
        ...

    def access_problem(self, folder: Path) -> str:
        """The reason why other users can change the files in ``folder``; empty if they cannot."""
        ...

    def all_may_write(self, mode: int) -> bool: ...
    def is_administrator(self) -> bool: ...
    def has_screen(self) -> bool: ...
    def lock(self, file: int) -> None:
        """Locks a file until it is closed or the process ends.  Raises OSError if another process has locked it."""
        ...

    def held(self, path: Path) -> AbstractContextManager[None]:
        """Locks a file or a folder.  Raises OSError if another process has locked it."""
        ...

    def end_signals(self) -> tuple[int, ...]:
        """The signals by which the system asks this program to end from now on, besides SIGINT."""
        ...

    def quoted(self, command: Sequence[str]) -> str:
        """The line that runs ``command`` in a shell."""
        ...

    def drives(self) -> list[Path]:
        """The folders of the drives that can be those of a boot program."""
        ...

    def usb_devices(self) -> list[str] | None:
        """The instance ids of Windows' attached USB devices, such as ``USB\\VID_0483&PID_374B\\0671FF``; else None."""
        ...

    def start(
        self, command: Sequence[str], folder: Path, environment: Mapping[str, str], *, modest: bool, bound: bool
    ) -> Group:
        """Starts a program without input, whose output and messages are one pipe.  Raises OSError.

        A ``modest`` one has a low priority.  A ``bound`` one ends with this program, however this one ends, where the
        system can do this: Linux and Windows.
        """
        ...


here = cast(OperatingSystem, importlib.import_module(f"epg.generator.system.on_{os.name}"))
