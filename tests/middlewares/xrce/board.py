# SPDX-License-Identifier: Apache-2.0
"""A board for tests: a host executable with the middleware ``xrce``, observed through an agent."""

from __future__ import annotations

import os
import re
import subprocess
import tempfile
from pathlib import Path

from tests.doubles.xrce_agent import Agent, Diagnostics, UdpLink, float64, read_diagnostics, read_float64

PATIENCE = 20.0
"""Longest time to wait, in seconds, on a machine that also runs other programs."""


def without_connection(errors: str) -> str:
    """``errors`` of a program without the lines that tell of a lost agent."""
    return re.sub(r"^\w+: (lost|connected to) the agent at .*\n", "", errors, flags=re.MULTILINE)


class Board:
    """Runs ``program`` in real time, connected to ``agent``; killed at the end of the ``with`` block."""

    def __init__(self, program: Path, agent: Agent, *options: str, serial: str = "1") -> None:
        way = "--agent" if isinstance(agent.link, UdpLink) else "--serial-device"
        command = [str(program), "--realtime", "--quiet", "--serial", serial, way, agent.address, *options]
        self.agent, self.topics = agent, agent.topics
        self.node = f"/lab/robot_{serial}"
        self._output = tempfile.TemporaryFile()  # noqa: SIM115 (closed by __exit__)
        self.process = subprocess.Popen(command, stdout=self._output, stderr=self._output)

    def __enter__(self) -> Board:
        return self

    def __exit__(self, *_: object) -> None:
        if self.process.poll() is None:
            self.process.kill()
        self.process.wait()
        self._output.close()

    def stop(self) -> str:
        """Ends the program normally; returns its output, which is empty unless a sanitizer reports an error.

        The lines that tell of a lost agent are left out.
        """
        self.process.terminate()
        assert self.process.wait(PATIENCE) == 130, self.said()
        return without_connection(self.said())

    def said(self) -> str:
        """All that the program has printed."""
        return os.pread(self._output.fileno(), 1 << 20, 0).decode()

    def lose(self) -> None:
        """Waits until the program has told that it has lost the agent."""
        self.agent.wait_until(lambda: self.said().rfind("lost the agent") > self.said().rfind("connected to the agent"))

    def kill(self) -> None:
        self.process.kill()
        self.process.wait()

    # Topics ----------------------------------------------------------------------------------------------------------

    def values(self, topic: str, since: int = 0) -> list[float]:
        return [read_float64(sample.data) for sample in self.topics.samples(f"rt/lab/{topic}", since, self.node)]

    def cycles(self) -> float:
        """The newest number of the model's cycles of 1 ms, which is the board's time."""
        return read_float64(self.topics.newest("rt/lab/cycles_too", self.node))

    def passes(self, cycles: float) -> None:
        """Waits until the board has done so many cycles more."""
        end = self.cycles() + cycles
        self.agent.wait_until(lambda: self.cycles() >= end)

    def publishes(self, count: int) -> None:
        """Waits for so many publications, one every 20 ms of the board's time.  A disabled board publishes, too."""
        for _ in range(count):
            self.next("cycles_too")

    def began(self) -> float:
        """The time in seconds of the first tick, by the stamp of the next diagnostics."""
        told = self.diagnostics()
        return told.stamp - (int(told.values["cycles"]) + int(told.values["missed"])) / 1000

    def next(self, topic: str, seconds: float = PATIENCE) -> float:
        return read_float64(self.topics.wait_for_sample(f"rt/lab/{topic}", seconds, self.node).data)

    def wait_for(self, topic: str, value: float, seconds: float = PATIENCE) -> float:
        """Waits until ``topic`` has this value from now on; returns how many cycles that took."""
        since, began = self.topics.count, self.cycles()
        self.agent.wait_until(lambda: value in self.values(topic, since), seconds)
        return self.cycles() - began

    def set(self, topic: str, value: float, reliable: bool = True) -> int:
        """Publishes a setpoint to all boards; returns the number of readers that match."""
        return self.topics.publish(f"rt/lab/{topic}", float64(value), reliable)

    def enable(self, on: bool) -> None:
        """Disables the board, and then enables it if ``on``: a message ``true`` acts only after a ``false``.

        A ``false`` of the first second after a connection only stops, because it can be an old one of the agent.
        """
        if on:
            self.publishes(55)
            self.topics.publish(f"rt{self.node}/enable", bytes([False]))
        self.topics.publish(f"rt{self.node}/enable", bytes([on]))

    def running(self, seconds: float = PATIENCE) -> float:
        """Waits until the board publishes from now on; returns the number of its cycles."""
        return self.next("cycles_too", seconds)

    def diagnostics(self, seconds: float = PATIENCE) -> Diagnostics:
        """The next diagnostics."""
        return read_diagnostics(self.topics.wait_for_sample("rt/diagnostics", seconds, self.node).data)

    def statistic(self, name: str) -> int:
        return int(self.diagnostics().values[name])

    # The process -----------------------------------------------------------------------------------------------------

    def memory(self) -> int:
        """Resident memory in bytes."""
        pages = int(Path(f"/proc/{self.process.pid}/statm").read_text().split()[1])
        return pages * os.sysconf("SC_PAGE_SIZE")

    def descriptors(self) -> int:
        return len(os.listdir(f"/proc/{self.process.pid}/fd"))
