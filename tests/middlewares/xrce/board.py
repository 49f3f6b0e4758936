# SPDX-License-Identifier: Apache-2.0
"""A board for tests: a host executable with the middleware ``xrce``, observed through an agent."""

from __future__ import annotations

import os
import re
import subprocess
import time
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
        self.process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)

    def __enter__(self) -> Board:
        return self

    def __exit__(self, *_: object) -> None:
        if self.process.poll() is None:
            self.process.kill()
        self.process.communicate()

    def stop(self) -> str:
        """Ends the program normally; returns its output, which is empty unless a sanitizer reports an error.

        The lines that tell of a lost agent are left out.
        """
        self.process.terminate()
        output, errors = self.process.communicate(timeout=PATIENCE)
        assert self.process.returncode == 130, errors
        return output + without_connection(errors)

    def kill(self) -> None:
        self.process.kill()
        self.process.wait()

    # Topics ----------------------------------------------------------------------------------------------------------

    def values(self, topic: str, since: float = 0.0) -> list[float]:
        return [value for _, value in self.timed(topic, since)]

    def timed(self, topic: str, since: float = 0.0) -> list[tuple[float, float]]:
        """The samples as pairs of time at the agent and value."""
        samples = self.topics.samples(f"rt/lab/{topic}", since, self.node)
        return [(sample.time, read_float64(sample.data)) for sample in samples]

    def began(self, since: float = 0.0) -> float:
        """The time at the agent of the model's cycle 0.  Of the samples since then, the soonest one counts."""
        return min(when - cycles / 1000 for when, cycles in self.timed("cycles_too", since))

    def next(self, topic: str, seconds: float = PATIENCE) -> float:
        return read_float64(self.topics.wait_for_sample(f"rt/lab/{topic}", seconds, self.node).data)

    def wait_for(self, topic: str, value: float, seconds: float = PATIENCE) -> float:
        """Waits until ``topic`` has this value from now on; returns how long that took."""
        began = time.monotonic()
        self.agent.wait_until(lambda: value in self.values(topic, began), seconds)
        return time.monotonic() - began

    def set(self, topic: str, value: float, reliable: bool = True) -> int:
        """Publishes a setpoint to all boards; returns the number of readers that match."""
        return self.topics.publish(f"rt/lab/{topic}", float64(value), reliable)

    def enable(self, on: bool) -> None:
        """Disables the board, and then enables it if ``on``: a message ``true`` acts only after a ``false``.

        A ``false`` of the first second after a connection only stops, because it can be an old one of the agent.
        """
        if on:
            time.sleep(1.1)
            self.topics.publish(f"rt{self.node}/enable", bytes([False]))
        self.topics.publish(f"rt{self.node}/enable", bytes([on]))

    def running(self, seconds: float = PATIENCE) -> float:
        """Waits until the board publishes from now on; returns how long that took."""
        began = time.monotonic()
        self.topics.wait_for_sample("rt/lab/cycles_too", seconds, self.node)
        return time.monotonic() - began

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
