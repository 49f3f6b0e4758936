# SPDX-License-Identifier: Apache-2.0
"""A separate network for each test: loopback only, in a domain that no other test uses at the same time."""

from __future__ import annotations

import os
import subprocess
import uuid
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

LOOPBACK = (
    "<CycloneDDS><Domain>"
    '<General><Interfaces><NetworkInterface address="127.0.0.1" multicast="true"/></Interfaces></General>'
    "{discovery}</Domain></CycloneDDS>"
)
TAG = "<Discovery><Tag>{tag}</Tag></Discovery>"
"""A tag that separates participants in the same domain: from other tests, and from the user's robots."""


@dataclass(frozen=True)
class Network:
    """``environment`` is for programs in the network; this process is in it during the ``with`` block."""

    domain: int
    environment: dict[str, str]

    def run(self, program: Path, *options: str) -> subprocess.Popen[str]:
        """Starts a host executable in real time."""
        command = [str(program), "--realtime", *options]
        return subprocess.Popen(
            command, env=self.environment, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
        )


@contextmanager
def network(domain: int = 17, tagged: bool = True) -> Iterator[Network]:
    """A new network.  CycloneDDS reads the environment when a process makes its first participant in a domain.

    Other implementations do not support tags: without a tag, no other program may use the domain.
    """
    uri = LOOPBACK.format(discovery=TAG.format(tag=f"epg_{uuid.uuid4().hex}") if tagged else "")
    added = {"CYCLONEDDS_URI": uri, "ROS_DOMAIN_ID": str(domain)}
    removed = ("ROS_AUTOMATIC_DISCOVERY_RANGE", "ROS_STATIC_PEERS", "ROS_LOCALHOST_ONLY")
    before = dict(os.environ)
    for name in removed:
        os.environ.pop(name, None)
    os.environ.update(added)
    try:
        yield Network(domain, dict(os.environ))
    finally:
        os.environ.clear()
        os.environ.update(before)


@contextmanager
def running(processes: Sequence[subprocess.Popen[str]]) -> Iterator[None]:
    """Kills the remaining ``processes`` at the end."""
    try:
        yield
    finally:
        for process in processes:
            if process.poll() is None:
                process.kill()
            process.communicate()
