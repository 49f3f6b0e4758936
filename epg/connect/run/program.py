# SPDX-License-Identifier: Apache-2.0
"""Runs a program for this computer in real time, until it ends or the user stops it.

>>> # run = ProgramRun(changed=wake_the_page)
>>> # run.start(Path("build/jiwy_host")); run.lines(0); run.cancel()
"""

from __future__ import annotations

import os
from pathlib import Path
from typing import ClassVar

from epg.connect.activity import Activity, Outcome
from epg.connect.build.messages import Message

LONGEST = 86400
"""The longest time in seconds that a program runs: a program that is no ROS 2 node needs a duration."""
_TAIL = 5


class ProgramRun(Activity):
    """One run of a program.  ``program`` in its state is the path of the program."""

    more: ClassVar = {"program": "", "can_try": False}

    def start(self, program: Path) -> None:
        self.shown["program"] = str(program)
        self.begin(lambda: self._run(program))

    def _run(self, program: Path) -> Outcome:
        status = self.run("run", command_of(program), program.parent, os.environ)
        if self.is_cancelled:
            return Outcome("cancelled")
        if status == 0:
            return Outcome("done")
        said = [line for line in self.lines(0) if line.strip()][-_TAIL:]
        text = "\n".join([f"'{program.name}' ended with status {status}", *said])
        return Outcome("failed", [Message("error", text, id="run-failed")])


def command_of(program: Path) -> tuple[str, ...]:
    """The command that runs ``program`` in real time.  It gives no setpoint, and does not enable the target."""
    return (str(program), "--realtime", f"--duration={LONGEST}")
