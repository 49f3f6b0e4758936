# SPDX-License-Identifier: Apache-2.0
"""A running target whose console is a UDP socket, with a trace of its cycles."""

from __future__ import annotations

import signal
import subprocess
from pathlib import Path

from epg.live.client import Client
from tests.live.target import last_enabled, read_trace, tick_of
from tests.waiting import until

Trace = list[dict[str, float]]


class UdpTarget:
    """The program.  ``port`` is the name of its port."""

    def __init__(
        self,
        program: Path,
        folder: Path,
        address: str = "0",
        namespace: tuple[str, ...] = (),
        options: tuple[str, ...] = (),
        duration: int = 60,
    ) -> None:
        self._trace = folder / "trace.csv"
        always = ("--realtime", "--console-udp", address, "--duration", str(duration), "--trace", str(self._trace))
        self.process = subprocess.Popen(
            [*namespace, str(program), *always, *options],
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
            cwd=folder,
        )
        assert self.process.stderr is not None
        self.said = self.process.stderr.readline()
        self.port = Path(self.said.split()[-1])

    @property
    def number(self) -> int:
        """Its UDP port."""
        return int(str(self.port).rpartition(":")[2])

    def last_enabled(self) -> float:
        """As :meth:`tests.live.target.Target.last_enabled`; ends the program."""
        tick = tick_of(self.port)
        return last_enabled(self.end(), tick)

    def end(self) -> Trace:
        """Ends the program, which must have found no error of memory; returns its trace."""
        self.process.send_signal(signal.SIGTERM)
        _, said = self.process.communicate(timeout=20)
        assert self.process.returncode == 130, said
        assert not said, said
        return read_trace(self._trace)


def is_soon_disabled(client: Client) -> bool:
    """True if the target becomes disabled.  The answer to a stop comes before the next control cycle."""
    return until(lambda: "enabled=0" in client.command("stats")[0], "it stays enabled", 2)
