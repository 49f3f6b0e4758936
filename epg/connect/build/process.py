# SPDX-License-Identifier: Apache-2.0
"""Starts a program, reads its output line by line, and can end it together with all programs that it has started.

>>> # process = Process(("cmake", "--build", "build"), Path("."), os.environ, print)
>>> # status = process.run()          process.cancel() from another thread
"""

from __future__ import annotations

import contextlib
import os
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

GRACE = 5.0
"""Seconds that programs get to end by themselves: Ninja and Make delete half-written files in this time."""
NICE = 10
"""The niceness of a modest program and of all that it starts."""


class Process:
    """One run of a program.  ``line`` is called with each line of its output and standard error, without line end.

    A ``modest`` program has a low priority, because a running target may be watched and stopped beside it.
    """

    def __init__(
        self,
        command: Sequence[str],
        folder: Path,
        environment: Mapping[str, str],
        line: Callable[[str], None],
        *,
        modest: bool = False,
    ) -> None:
        self._modest = modest
        self._command, self._folder, self._environment, self._line = command, folder, environment, line
        self._lock = threading.Lock()
        self._process: subprocess.Popen[bytes] | None = None
        self._cancelled = False

    def run(self) -> int:
        """Runs the program to its end, and returns its exit status.  Raises OSError if it cannot be started."""
        with self._lock:
            if self._cancelled:
                return -signal.SIGTERM
            self._process = self._start()
            if self._modest and sys.platform != "win32":
                with contextlib.suppress(OSError):  # it has ended already
                    os.setpriority(os.PRIO_PROCESS, self._process.pid, NICE)
        reader = threading.Thread(target=self._read, name="output of a build", daemon=True)
        reader.start()
        status = self._process.wait()
        if self._cancelled:
            _end_all(self._process.pid)
        reader.join(GRACE)  # a program that still runs in the background may keep the pipe open
        return status

    def cancel(self) -> None:
        """Asks the program and all that it has started to end.  Kills them after :data:`GRACE`.  Returns at once."""
        with self._lock:
            already, self._cancelled = self._cancelled, True
            process = self._process
        if process is None or already or process.poll() is not None:
            return
        _ask_to_end(process)
        timer = threading.Timer(GRACE, process.kill)
        timer.daemon = True
        timer.start()

    def _start(self) -> subprocess.Popen[bytes]:
        new_group = getattr(subprocess, "CREATE_NEW_PROCESS_GROUP", 0)
        return subprocess.Popen(
            list(self._command),
            cwd=self._folder,
            env=dict(self._environment),
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            start_new_session=True,  # POSIX: a signal reaches the whole group, and Ctrl-C in the terminal does not
            creationflags=new_group,  # Windows
        )

    def _read(self) -> None:
        assert self._process is not None and self._process.stdout is not None
        with self._process.stdout as output:
            for line in output:
                self._line(line.decode("utf-8", "replace").rstrip("\r\n"))


def _ask_to_end(process: subprocess.Popen[bytes]) -> None:
    try:
        if sys.platform == "win32":
            process.send_signal(signal.CTRL_BREAK_EVENT)
        else:
            os.killpg(process.pid, signal.SIGTERM)
    except OSError:
        process.terminate()


def _end_all(leader: int) -> None:
    """Waits at most :data:`GRACE` until all processes of the session of ``leader`` have ended, and kills the others."""
    if sys.platform == "win32":
        return
    until = time.monotonic() + GRACE
    while (left := _session(leader)) and time.monotonic() < until:
        time.sleep(0.02)
    for process in left:
        try:
            os.kill(process, signal.SIGKILL)
        except OSError:
            pass  # it has ended in the meantime
    try:
        os.killpg(leader, signal.SIGKILL)
    except OSError:
        pass


def _session(leader: int) -> list[int]:
    """The running processes of a session.  Empty on systems other than Linux.

    The leader's process group is not enough: Ninja starts each command in a new process group.
    """
    members = []
    for entry in Path("/proc").glob("[0-9]*"):
        try:
            fields = (entry / "stat").read_text(encoding="utf-8", errors="replace").rpartition(")")[2].split()
        except OSError:
            continue
        if fields[0] != "Z" and fields[3] == str(leader):  # state; session
            members.append(int(entry.name))
    return members
