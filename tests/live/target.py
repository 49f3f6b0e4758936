# SPDX-License-Identifier: Apache-2.0
"""A running target for tests: JIWY with its simulated plant, in real time, with a terminal as its serial port."""

from __future__ import annotations

import subprocess
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from epg.live.client import Client
from epg.live.port import Port
from tests.middlewares.conftest import build_jiwy

LEASE = 0.3  # seconds
LATE = 0.4  # more seconds that this computer may take; the times of the target itself are tested in c/live_tests.c


@pytest.fixture(scope="session")
def jiwy_host(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return build_jiwy(tmp_path_factory.mktemp("jiwy"), "address,undefined")


class Target:
    """The program, and the terminal that is its serial port."""

    def __init__(self, program: Path, folder: Path) -> None:
        self.port = folder / "port"
        self.process = subprocess.Popen(
            [str(program), "--realtime", "--console-pty", str(self.port)],
            stdout=subprocess.PIPE,
            text=True,
            cwd=folder,
        )
        end = time.monotonic() + 10
        while not self.port.exists() and time.monotonic() < end:
            time.sleep(0.01)

    def report(self) -> str:
        """Ends the program and returns its report."""
        self.process.terminate()
        return self.process.communicate(timeout=20)[0]

    def is_enabled(self) -> bool:
        """Asks a port that no program has."""
        with Port(self.port) as port:
            client = Client(port)
            try:
                return "enabled=1" in client.command("stats")[0]
            finally:
                client.stop()


@pytest.fixture
def target(jiwy_host: Path, tmp_path: Path) -> Iterator[Target]:
    found = Target(jiwy_host, tmp_path)
    yield found
    found.process.kill()
    found.process.communicate()
