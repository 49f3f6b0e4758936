# SPDX-License-Identifier: Apache-2.0
"""``epg connect`` as a user starts it, and its answers over HTTP.

>>> # with Served(folder) as epg: epg.address, epg.state(), epg.post("undo")
"""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

from tests.connect.page import Page

ROOT = Path(__file__).resolve().parents[3]


class Served(Page):
    """A process that serves the page: for a folder with a project, a bare model, or whatever the options name."""

    def __init__(self, *arguments: Path | str) -> None:
        command = [sys.executable, "-m", "epg", "connect", *map(str, arguments), "--no-browser"]
        packages = [str(ROOT), *filter(None, [os.environ.get("PYTHONPATH")])]
        environment = {**os.environ, "PYTHONPATH": os.pathsep.join(packages), "EPG_PATH": str(ROOT)}
        self._process = subprocess.Popen(command, stdout=subprocess.PIPE, text=True, encoding="utf-8", env=environment)
        assert self._process.stdout is not None
        self._lines = 0
        super().__init__(self.address)

    @property
    def address(self) -> str:
        """An unused address.  After its use, the program prints the next one."""
        assert self._process.stdout is not None
        before = ("epg connect: ", "Press ", "epg connect: for another page: ")
        while True:
            line = self._process.stdout.readline()
            assert line.startswith(before[min(self._lines, 2)]), line
            self._lines += 1
            if "http" in line:
                return line.split()[-1]

    @property
    def process(self) -> int:
        """The number of the process."""
        return self._process.pid

    def __enter__(self) -> Served:
        return self

    def __exit__(self, *_: object) -> None:
        self.end()

    def end(self) -> None:
        """Ends the process as Ctrl-C does."""
        self._process.terminate()
        self._process.wait(timeout=10)
        assert self._process.stdout is not None
        self._process.stdout.close()

    def kill(self) -> None:
        """Ends the process as a crash does."""
        self._process.kill()
        self._process.wait(timeout=10)
        assert self._process.stdout is not None
        self._process.stdout.close()

    def wait(self) -> int:
        """Waits until the process ends by itself; returns its exit code."""
        return self._process.wait(timeout=10)
