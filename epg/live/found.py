# SPDX-License-Identifier: Apache-2.0
"""The serial ports of this computer, and the target behind each of them.

Only ports of USB devices that can have firmware of EPG are asked: opening a port can restart another device, and bytes
can make it act.  A port that a program of this user has open is not touched.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path

from epg.live.client import Client, CommandRefused, Lost, TargetDescription
from epg.live.port import PortError, SerialPort
from epg.live.ports import system


@dataclass(frozen=True)
class Found:
    """A serial port, the name that its device gives itself, and its target or the reason why there is none."""

    path: Path
    device: str
    target: TargetDescription | None
    reason: str


def ports() -> dict[Path, str]:
    """The serial ports with the names that their devices give themselves, which are empty if they are not known."""
    try:
        return {port.path: port.device for port in system().list_ports()}
    except PortError:
        return {}  # a system without ports


def look_at_all(devices: Mapping[Path, str], vendors: Collection[str]) -> list[Found]:
    """Asks the targets behind ports of USB ``vendors``, all at the same time: in less than 2 s."""
    if not devices:
        return []
    with ThreadPoolExecutor(len(devices)) as pool:
        return list(pool.map(lambda path: _look_at(path, devices[path], vendors), devices))


def _look_at(path: Path, device: str, vendors: Collection[str]) -> Found:
    """Asks the target behind a port to describe itself, if the port is that of a board and is not in use."""
    if system().usb_port(path).vendor not in vendors:
        return Found(path, device, None, "not asked: it is not a board that EPG knows")
    user = system().program_with(path)
    if user:
        return Found(path, device, None, f"in use by {user}")
    try:
        with SerialPort(path) as port:
            client = Client(port, tries=1, patience=0.7)  # a silent port takes twice this time
            try:
                return Found(path, device, client.description, "")
            finally:
                client.stop()
    except (PortError, Lost, CommandRefused) as problem:
        return Found(path, device, None, str(problem))
