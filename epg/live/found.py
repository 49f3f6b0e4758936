# SPDX-License-Identifier: Apache-2.0
"""The serial ports of this computer, and the target behind each of them."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from epg.live.client import Client, Description, Lost, Refused
from epg.live.port import Port, PortError

_BY_ID = Path("/dev/serial/by-id")
_PATTERNS = ("ttyACM*", "ttyUSB*", "cu.usb*")


@dataclass(frozen=True)
class Found:
    """A serial port, the name that its device gives itself, and its target or the reason why there is none."""

    path: Path
    device: str
    target: Description | None
    reason: str


def ports() -> dict[Path, str]:
    """The serial ports with the names that their devices give themselves, which are empty if they are not known."""
    names = {link.resolve(): link.name for link in _BY_ID.glob("*")} if _BY_ID.is_dir() else {}
    paths = sorted(path for pattern in _PATTERNS for path in Path("/dev").glob(pattern))
    return {path: names.get(path, "") for path in paths}


def look_at(path: Path, device: str = "") -> Found:
    """Asks the target behind a port to describe itself."""
    try:
        with Port(path) as port:
            client = Client(port)
            try:
                return Found(path, device, client.description, "")
            finally:
                client.stop()
    except (PortError, Lost, Refused) as problem:
        return Found(path, device, None, str(problem))
