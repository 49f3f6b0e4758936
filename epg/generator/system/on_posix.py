# SPDX-License-Identifier: Apache-2.0
"""Linux and macOS."""

from __future__ import annotations

import os
import re
import signal
import stat
import sys
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path

NAME = "macos" if sys.platform == "darwin" else "linux"
NOT_IN_PROJECTS = r'[#<>?:;"\\]'
SHARES_PORTS = True
HAS_TERMINALS = True
LOCKS_PROGRAMS = False
NICE = 10
"""The niceness of a modest program and of all that it starts."""
MOUNTS = Path("/proc/self/mounts")
"""The file in which Linux lists the folders of all drives."""
_UNTIL_PARENT_ENDS = (
    "import ctypes, os, signal, sys\n"
    "ctypes.CDLL(None).prctl(1, signal.SIGTERM)\n"  # PR_SET_PDEATHSIG of Linux, which outlasts exec
    "if os.getppid() == int(sys.argv[1]):\n"
    "    try: os.execv(sys.argv[2], sys.argv[2:])\n"
    "    except OSError as error: sys.exit(error.strerror)\n"
)
"""A script that becomes a program, which Linux ends with its parent: also after SIGKILL, which nothing can handle."""


def caches() -> Path:
    return Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache")


def settings() -> Path:
    return Path(os.environ.get("XDG_CONFIG_HOME") or Path.home() / ".config")


def own_users() -> set[int]:
    own = {0, os.geteuid()}
    if os.geteuid() == 0 and os.environ.get("SUDO_UID", "").isdecimal():
        own.add(int(os.environ["SUDO_UID"][:10]))
    return own


def access_problem(folder: Path) -> str:
    try:
        status = folder.stat()
    except OSError:
        return ""  # The function that uses the folder reports the problem.
    if status.st_uid not in own_users():
        return f"it belongs to another user (number {status.st_uid})"
    if status.st_mode & 0o002 or (status.st_mode & 0o020 and not _is_own_group(status.st_gid)):
        return f"other users can write into it (mode {status.st_mode & 0o7777:o})"
    return ""


def _is_own_group(group: int) -> bool:
    """True if the user is the only member of a group.

    Many systems make such a group for each user, and by default they allow it to write into the user's folders.
    """
    import grp
    import pwd

    try:
        user, found = pwd.getpwuid(os.geteuid()), grp.getgrgid(group)
    except KeyError:
        return False
    return user.pw_gid == group and found.gr_name == user.pw_name and set(found.gr_mem) <= {user.pw_name}


def all_may_write(mode: int) -> bool:
    return bool(mode & stat.S_IWOTH)


def is_administrator() -> bool:
    return os.geteuid() == 0


def has_screen() -> bool:
    return sys.platform == "darwin" or any(map(os.environ.get, ("DISPLAY", "WAYLAND_DISPLAY", "BROWSER")))


def lock(file: int) -> None:
    import fcntl

    fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)


@contextmanager
def held(path: Path) -> Iterator[None]:
    handle = os.open(path, os.O_RDONLY)
    try:
        lock(handle)
        yield
    finally:
        os.close(handle)


def end_signals() -> tuple[int, ...]:
    return (signal.SIGTERM, signal.SIGHUP)


def quoted(command: Sequence[str]) -> str:
    import shlex

    return shlex.join(command)


def usb_devices() -> None:
    return None


def drives() -> list[Path]:
    if sys.platform == "darwin":
        return sorted(Path("/Volumes").glob("*"))
    try:
        lines = MOUNTS.read_text(encoding="utf-8", errors="surrogateescape").splitlines()
    except OSError:
        return []
    # proc_pid_mounts(5): blanks and other characters of a name are octal numbers
    entries = [line.split(" ") for line in lines]
    names = [fields[1] for fields in entries if len(fields) > 2 and fields[2] in ("vfat", "msdos")]
    return [Path(re.sub(r"\\([0-7]{3})", lambda octal: chr(int(octal[1], 8)), name)) for name in names]


class PosixSession:
    """A program that leads a session.  Its process group is not enough: Ninja starts each command in a new one."""

    def __init__(self, command: Sequence[str], folder: Path, environment: Mapping[str, str]) -> None:
        import subprocess

        self.process = subprocess.Popen(
            list(command),
            cwd=folder,
            env=dict(environment),
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            start_new_session=True,  # a signal reaches the whole group, and Ctrl-C in the terminal does not
        )

    def ask_to_end(self) -> None:
        try:
            os.killpg(self.process.pid, signal.SIGTERM)
        except OSError:
            self.process.terminate()

    def is_running(self) -> bool:
        return bool(self._members())

    def kill(self) -> None:
        for process in self._members():
            with suppress(OSError):  # it has ended in the meantime
                os.kill(process, signal.SIGKILL)
        with suppress(OSError):
            os.killpg(self.process.pid, signal.SIGKILL)

    def _members(self) -> list[int]:
        """The running processes of the session."""
        if sys.platform == "darwin":  # which has no /proc
            return [process for process in _running() if _session_of(process) == self.process.pid]
        members = []
        for entry in Path("/proc").glob("[0-9]*"):
            try:
                fields = (entry / "stat").read_text(encoding="utf-8", errors="replace").rpartition(")")[2].split()
            except OSError:
                continue
            if fields[0] != "Z" and fields[3] == str(self.process.pid):  # state; session
                members.append(int(entry.name))
        return members


def _running() -> Iterator[int]:
    import subprocess

    listed = subprocess.run(["ps", "-axo", "pid=,stat="], capture_output=True, text=True, check=False)
    yield from (int(line.split()[0]) for line in listed.stdout.splitlines() if "Z" not in line)


def _session_of(process: int) -> int:
    """The process that leads the session of a process; -1 if the process has ended."""
    try:
        return os.getsid(process)
    except OSError:
        return -1


def start(
    command: Sequence[str], folder: Path, environment: Mapping[str, str], *, modest: bool, bound: bool
) -> PosixSession:
    if bound and sys.platform == "linux":
        command = (sys.executable, "-I", "-S", "-c", _UNTIL_PARENT_ENDS, str(os.getpid()), *command)
    session = PosixSession(command, folder, environment)
    if modest:
        with suppress(OSError):  # it has ended already
            os.setpriority(os.PRIO_PROCESS, session.process.pid, NICE)
    return session
