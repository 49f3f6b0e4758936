# SPDX-License-Identifier: Apache-2.0
"""Runs a program for this computer in real time, until it ends or the user stops it, and never longer than EPG.

>>> # run = ProgramRun(changed=wake_the_page)
>>> # run.start(Path("build/jiwy_host")); run.lines(0); run.cancel()
"""

from __future__ import annotations

import os
import re
from pathlib import Path
from typing import ClassVar

from epg.connect.activity import Activity, Outcome
from epg.connect.build.build_messages import BuildMessage
from epg.generator.system import here
from epg.live.udp import PREFIX, is_udp

LONGEST = 86400
"""The longest time in seconds that a program runs: a program that is no ROS 2 node needs a duration."""
ANY_SOCKET = Path("udp:127.0.0.1:0")
"""A socket that the system chooses when the program starts."""
_LISTENS = re.compile(r": the console listens on (udp:\S+)$")
_TAIL = 5


class ProgramRun(Activity):
    """One run of a program.  Its state has the ``program``, and the ``port`` of its console, or an empty text."""

    more: ClassVar = {"program": "", "port": "", "can_try": False}

    def start(self, program: Path, port: Path | None) -> None:
        """``port`` is that of :func:`port_of`; None: the program has no console."""
        if port is not None and port.is_symlink():
            port.unlink()  # of a program that was killed: its terminal can belong to another program now
        self.shown |= {"program": str(program), "port": "" if port == ANY_SOCKET else str(port or "")}
        self.begin(lambda: self._run(program, port))

    def _run(self, program: Path, port: Path | None) -> Outcome:
        status = self.run(
            "run", command_of(program, port), program.parent, os.environ, line=self._find_socket, bound=True
        )
        if self.is_cancelled:
            return Outcome("cancelled")
        if status == 0:
            return Outcome("done")
        said = [line for line in self.lines(0) if line.strip()][-_TAIL:]
        text = "\n".join([f"'{program.name}' ended with status {status}", *said])
        return Outcome("failed", [BuildMessage("error", text, id="run-failed")])

    def _find_socket(self, line: str) -> None:
        """Reads a line of output, which can tell the socket of the console."""
        self.read(line)
        found = _LISTENS.search(line)
        if found is not None and not self.shown["port"]:
            self.shown["port"] = found[1]
            self._changed()

    @property
    def console(self) -> Path | None:
        """The port of the console, once it is there."""
        port = Path(self.shown["port"])
        return port if self.shown["port"] and (is_udp(port) or port.exists()) else None


def command_of(program: Path, port: Path | None) -> tuple[str, ...]:
    """The command that runs ``program`` in real time.  It gives no setpoint, and does not enable the target."""
    if port is None:
        console = []
    elif is_udp(port):
        console = [f"--console-udp={str(port).removeprefix(PREFIX)}"]
    else:
        console = [f"--console-pty={port}"]
    return (str(program), *console, "--realtime", f"--duration={LONGEST}")


def port_of(program: Path) -> Path:
    """The terminal of a program's console: a link beside the program.  Without terminals, a socket."""
    return program.with_name(f"{program.name}.port") if here.HAS_TERMINALS else ANY_SOCKET
