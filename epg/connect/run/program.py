# SPDX-License-Identifier: Apache-2.0
"""Runs a program for this computer in real time, until it ends or the user stops it, and never longer than EPG.

>>> # run = ProgramRun(changed=wake_the_page)
>>> # run.start(Path("build/jiwy_host")); run.lines(0); run.cancel()
"""

from __future__ import annotations

import hashlib
import os
import re
import secrets
from pathlib import Path, PurePath
from typing import ClassVar

from epg.connect.activity import Activity, Outcome
from epg.connect.build.build_messages import BuildMessage
from epg.connect.build.process import GRACE
from epg.generator.system import here
from epg.live.port import PortError
from epg.live.udp import PREFIX, is_udp
from epg.live.udp_keys import file_of, forget_key, keep_key
from epg.live.udp_seal import KEY

LONGEST = 86400
"""The longest time in seconds that a program runs: a program that is no ROS 2 node needs a duration."""
ANY_SOCKET = Path("udp:127.0.0.1:0")
"""A socket that the system chooses when the program starts.  Each run has another key for it."""
_LISTENS = re.compile(r": the console listens on (udp:127\.0\.0\.1:\d+)$")
_TAIL = 5


class ProgramRun(Activity):
    """One run of a program.  Its state has the ``program``, and the ``port`` of its console, or an empty text."""

    more: ClassVar = {"program": "", "port": "", "can_try": False}
    _key = _why = ""
    _kept: tuple[PurePath, ...] = ()

    def start(self, program: Path, port: Path | None) -> None:
        """``port`` is that of :func:`port_of`; None: the program has no console."""
        if port is not None and port.is_symlink():
            port.unlink()  # of a program that was killed: its terminal can belong to another program now
        self.shown |= {"program": str(program), "port": "" if port == ANY_SOCKET else str(port or "")}
        self.begin(lambda: self._run(program, port))

    def stop(self, why: str) -> str:
        """Ends the program, and waits for the end.  Shows the reason, and returns it."""
        self._why = why
        self.cancel()
        self.wait(3 * GRACE)
        return why

    def _run(self, program: Path, port: Path | None) -> Outcome:
        try:
            if port == ANY_SOCKET:
                self._key = secrets.token_hex(KEY)
                self._keep(_key_of(program))
            status = self.run(
                "run", command_of(program, port), program.parent, os.environ, line=self._find_socket, bound=True
            )
        except PortError as problem:
            return Outcome("failed", [BuildMessage("error", str(problem), hint=problem.hint, id="run-failed")])
        finally:
            for path in self._kept:
                forget_key(path)
        if self.is_cancelled:
            return Outcome("cancelled", [BuildMessage("warning", self._why)] if self._why else ())
        if status == 0:
            return Outcome("done")
        said = [line for line in self.lines(0) if line.strip()][-_TAIL:]
        text = "\n".join([f"'{program.name}' ended with status {status}", *said])
        return Outcome("failed", [BuildMessage("error", text, id="run-failed")])

    def _find_socket(self, line: str) -> None:
        """Reads a line of output, which can tell the socket of the console."""
        self.read(line)
        found = _LISTENS.search(line)
        if found is not None and self._key and not self.shown["port"]:
            try:
                self._keep(PurePath(found[1]))
            except PortError as problem:  # the page asks for the key
                self.read(str(problem))
            self.shown["port"] = found[1]
            self._changed()

    def _keep(self, path: PurePath) -> None:
        keep_key(path, self._key)
        self._kept += (path,)

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
        console = [f"--console-udp={str(port).removeprefix(PREFIX)}", f"--console-key={file_of(_key_of(program))}"]
    else:
        console = [f"--console-pty={port}"]
    return (str(program), *console, "--realtime", f"--duration={LONGEST}")


def _key_of(program: Path) -> PurePath:
    """The name under which the key is kept until the program knows its socket.  It is the same in each run."""
    return PurePath(f"run:{hashlib.sha256(os.fsencode(program)).hexdigest()[:16]}")


def port_of(program: Path) -> Path:
    """The terminal of a program's console: a link beside the program.  Without terminals, a socket."""
    return program.with_name(f"{program.name}.port") if here.HAS_TERMINALS else ANY_SOCKET
