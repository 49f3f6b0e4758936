# SPDX-License-Identifier: Apache-2.0
"""A running target whose console is a UDP socket, with a trace of its cycles."""

from __future__ import annotations

import csv
import signal
import subprocess
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from epg.live.client import Client
from epg.live.udp import UdpPort

Trace = list[dict[str, float]]


class UdpTarget:
    """The program.  ``port`` is the name of its port."""

    def __init__(self, program: Path, folder: Path, address: str = "0", namespace: tuple[str, ...] = ()) -> None:
        self._trace = folder / "trace.csv"
        options = ("--realtime", "--console-udp", address, "--duration", "60", "--trace", str(self._trace))
        self.process = subprocess.Popen(
            [*namespace, str(program), *options],
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

    def end(self) -> Trace:
        """Ends the program, which must have found no error of memory; returns its trace."""
        self.process.send_signal(signal.SIGTERM)
        _, said = self.process.communicate(timeout=20)
        assert self.process.returncode == 130, said
        assert not said.replace("warning: anyone", ""), said
        with self._trace.open() as file:
            return [{name: float(value) for name, value in row.items()} for row in csv.DictReader(file)]


@contextmanager
def client_of(port: Path) -> Iterator[Client]:
    """A client of a target."""
    with UdpPort(port) as opened:
        client = Client(opened)
        try:
            yield client
        finally:
            client.stop()
