# SPDX-License-Identifier: Apache-2.0
"""eProsima's agent, if it is installed: ``EPG_XRCE_AGENT`` names the program, or ``MicroXRCEAgent`` is on ``PATH``.

Version 2.4.2 builds with Debian 12's Fast DDS.  It needs the packages ``libfastrtps-dev``, ``libfastcdr-dev``,
``libasio-dev``, ``libtinyxml2-dev`` and ``libssl-dev``, and the CMake options ``UAGENT_SUPERBUILD=OFF``,
``UAGENT_USE_SYSTEM_FASTDDS=ON``, ``UAGENT_USE_SYSTEM_FASTCDR=ON``, ``UAGENT_CED_PROFILE=OFF``,
``UAGENT_P2P_PROFILE=OFF``, ``UAGENT_DISCOVERY_PROFILE=OFF`` and ``UAGENT_LOGGER_PROFILE=OFF``.

It is limited to the loopback interface and to one DDS domain, so that tests do not disturb each other.
"""

from __future__ import annotations

import os
import secrets
import shutil
import signal
import subprocess
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path

from tests.doubles.toolchain import Missing

from .links import UdpLink

FAST_DDS = """<?xml version="1.0" encoding="UTF-8"?>
<dds xmlns="http://www.eprosima.com/XMLSchemas/fastRTPS_Profiles"><profiles>
<transport_descriptors><transport_descriptor>
  <transport_id>loopback</transport_id><type>UDPv4</type>
  <interfaceWhiteList><address>127.0.0.1</address></interfaceWhiteList>
</transport_descriptor></transport_descriptors>
<participant profile_name="default" is_default_profile="true"><rtps>
  <userTransports><transport_id>loopback</transport_id></userTransports>
  <useBuiltinTransports>false</useBuiltinTransports>
</rtps></participant>
</profiles></dds>
"""
CYCLONE = (
    "<CycloneDDS><Domain><General><Interfaces>"
    '<NetworkInterface address="127.0.0.1" multicast="true"/>'
    "</Interfaces></General></Domain></CycloneDDS>"
)


def program() -> Path:
    """The agent; raises :class:`Missing`."""
    named = os.environ.get("EPG_XRCE_AGENT") or shutil.which("MicroXRCEAgent")
    if not named or not Path(named).is_file():
        raise Missing(
            "EPG_XRCE_AGENT does not name eProsima's agent: tests/doubles/xrce_agent/real_agent.py says how to get one"
        )
    return Path(named)


def free_port() -> int:
    link = UdpLink()
    link.close()
    return link.port


def free_domain() -> int:
    """A domain that other test processes probably do not use; ROS 2 allows 0 to 101 on Linux."""
    return 30 + secrets.randbelow(70)


@contextmanager
def on_loopback() -> Iterator[None]:
    """Limits CycloneDDS of this process to the loopback interface, in domains that it has not joined before."""
    before = os.environ.get("CYCLONEDDS_URI")
    os.environ["CYCLONEDDS_URI"] = CYCLONE
    try:
        yield
    finally:
        if before is None:
            del os.environ["CYCLONEDDS_URI"]
        else:
            os.environ["CYCLONEDDS_URI"] = before


@dataclass
class RealAgent:
    """``arguments``: for example "udp4 -p 8888" or "serial -D /dev/pts/3".  ``agent``: another agent's program."""

    arguments: list[str]
    domain: int
    folder: Path
    agent: Path | None = None
    process: subprocess.Popen[bytes] | None = field(default=None, init=False)

    @classmethod
    def udp(cls, folder: Path, agent: Path | None = None) -> RealAgent:
        return cls(["udp4", "-p", str(free_port())], free_domain(), folder, agent)

    @property
    def address(self) -> str:
        return f"127.0.0.1:{self.arguments[-1]}" if self.arguments[0] == "udp4" else self.arguments[-1]

    def start(self) -> None:
        profile = self.folder / "fast_dds.xml"
        profile.write_text(FAST_DDS)
        environment = {**os.environ, "FASTRTPS_DEFAULT_PROFILES_FILE": str(profile)}
        environment["XRCE_DOMAIN_ID_OVERRIDE"] = str(self.domain)
        self.process = subprocess.Popen(
            [str(self.agent or program()), *self.arguments],
            env=environment,
            stdin=subprocess.PIPE,  # the agent ends when its input ends
            stdout=subprocess.DEVNULL,
        )

    def signal(self, number: signal.Signals) -> None:
        assert self.process is not None
        self.process.send_signal(number)

    def kill(self) -> None:
        if self.process is not None:
            self.process.kill()
            self.process.communicate()
            self.process = None

    def restart(self) -> None:
        self.kill()
        self.start()

    def __enter__(self) -> RealAgent:
        self.start()
        return self

    def __exit__(self, *_: object) -> None:
        self.kill()
