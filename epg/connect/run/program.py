# SPDX-License-Identifier: Apache-2.0
"""Runs a program for this computer in real time, until it ends or the user stops it, and never longer than EPG.

>>> # run = ProgramRun(changed=wake_the_page)
>>> # run.start(Path("build/jiwy_host")); run.lines(0); run.cancel()
"""

from __future__ import annotations

import os
from pathlib import Path
from typing import ClassVar

from epg.connect.activity import Activity, Outcome
from epg.connect.build.build_messages import BuildMessage

LONGEST = 86400
"""The longest time in seconds that a program runs: a program that is no ROS 2 node needs a duration."""
_TAIL = 5


class ProgramRun(Activity):
    """One run of a program.  Its state has the ``program``, and the ``port`` of its console, or an empty text."""

    more: ClassVar = {"program": "", "port": "", "can_try": False}

    def start(self, program: Path, port: Path | None) -> None:
        """``port`` is the terminal that the program makes for its console; None: it has no console."""
        if port is not None and port.is_symlink():
            port.unlink()  # of a program that was killed: its terminal can belong to another program now
        self.shown |= {"program": str(program), "port": str(port or "")}
        self.begin(lambda: self._run(program, port))

    def _run(self, program: Path, port: Path | None) -> Outcome:
        status = self.run("run", command_of(program, port), program.parent, os.environ, bound=True)
        if self.is_cancelled:
            return Outcome("cancelled")
        if status == 0:
            return Outcome("done")
        said = [line for line in self.lines(0) if line.strip()][-_TAIL:]
        text = "\n".join([f"'{program.name}' ended with status {status}", *said])
        return Outcome("failed", [BuildMessage("error", text, id="run-failed")])


def command_of(program: Path, port: Path | None) -> tuple[str, ...]:
    """The command that runs ``program`` in real time.  It gives no setpoint, and does not enable the target."""
    console = () if port is None else (f"--console-pty={port}",)
    return (str(program), *console, "--realtime", f"--duration={LONGEST}")


def port_of(program: Path) -> Path:
    """The terminal of a program's console: a link beside the program."""
    return program.with_name(f"{program.name}.port")
