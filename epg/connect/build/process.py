# SPDX-License-Identifier: Apache-2.0
"""Starts a program, reads its output line by line, and can end it together with all programs that it has started.

>>> # process = Process(("cmake", "--build", "build"), Path("."), os.environ, print)
>>> # status = process.run()          process.cancel() from another thread
"""

from __future__ import annotations

import signal
import threading
import time
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

from epg.generator.system import Group, here

GRACE = 5.0
"""Seconds that programs get to end by themselves: Ninja and Make delete half-written files in this time."""


class Process:
    """One run of a program.  ``line`` is called with each line of its output and standard error, without line end.

    A ``modest`` program has a low priority, because a running target may be watched and stopped beside it.  A ``bound``
    one never runs longer than EPG, where the system can do this.
    """

    def __init__(
        self,
        command: Sequence[str],
        folder: Path,
        environment: Mapping[str, str],
        line: Callable[[str], None],
        *,
        modest: bool = False,
        bound: bool = False,
    ) -> None:
        self._modest, self._bound = modest, bound
        self._command, self._folder, self._environment, self._line = command, folder, environment, line
        self._lock = threading.Lock()
        self._group: Group | None = None
        self._cancelled = False

    def run(self) -> int:
        """Runs the program to its end, and returns its exit status.  Raises OSError if it cannot be started."""
        with self._lock:
            if self._cancelled:
                return -signal.SIGTERM
            group = self._group = here.start(
                self._command, self._folder, self._environment, modest=self._modest, bound=self._bound
            )
        reader = threading.Thread(target=self._read, args=(group,), name="output of a build", daemon=True)
        reader.start()
        status = group.process.wait()
        if self._cancelled:
            _end_all(group)
        reader.join(GRACE)  # a program that still runs in the background may keep the pipe open
        return status

    def cancel(self) -> None:
        """Asks the program and all that it has started to end.  Kills them after :data:`GRACE`.  Returns at once."""
        with self._lock:
            already, self._cancelled = self._cancelled, True
            group = self._group
        if group is None or already or group.process.poll() is not None:
            return
        group.ask_to_end()
        timer = threading.Timer(GRACE, group.process.kill)
        timer.daemon = True
        timer.start()

    def _read(self, group: Group) -> None:
        assert group.process.stdout is not None
        with group.process.stdout as output:
            for line in output:
                self._line(line.decode("utf-8", "replace").rstrip("\r\n"))


def _end_all(group: Group) -> None:
    """Waits at most :data:`GRACE` until all programs of the group have ended, and kills the others."""
    until = time.monotonic() + GRACE
    while group.is_running() and time.monotonic() < until:
        time.sleep(0.02)
    group.kill()
