# SPDX-License-Identifier: Apache-2.0
"""The serial ports of this computer, and the target behind each of them.

Only ports of USB devices that can have firmware of EPG are asked: opening a port can restart another device, and bytes
can make it act.  A port that a program of this user has open is not touched.
"""

from __future__ import annotations

from collections.abc import Mapping
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path

from epg.live.client import Client, CommandRefused, Lost, TargetDescription
from epg.live.port import PortError, SerialPort, program_with

_BY_ID = Path("/dev/serial/by-id")
_PATTERNS = ("ttyACM*", "ttyUSB*", "cu.usb*")
DEVICES = Path("/sys/class/tty")
"""The folder in which Linux has a folder for each terminal."""
VENDORS = {"2e8a": "Raspberry Pi", "0483": "STMicroelectronics", "2fe3": "Zephyr"}
"""USB vendors of boards with EPG and of their debug probes, without a vendor that ``communication.usb`` sets."""


@dataclass(frozen=True)
class Found:
    """A serial port, the name that its device gives itself, and its target or the reason why there is none."""

    path: Path
    device: str
    target: TargetDescription | None
    reason: str


def ports() -> dict[Path, str]:
    """The serial ports with the names that their devices give themselves, which are empty if they are not known."""
    names = {link.resolve(): link.name for link in _BY_ID.glob("*")} if _BY_ID.is_dir() else {}
    paths = sorted(path for pattern in _PATTERNS for path in Path("/dev").glob(pattern))
    return {path: names.get(path, "") for path in paths}


def look_at_all(devices: Mapping[Path, str]) -> list[Found]:
    """Asks the targets behind ports, all at the same time: in less than 2 s."""
    if not devices:
        return []
    with ThreadPoolExecutor(len(devices)) as pool:
        return list(pool.map(look_at, devices, devices.values()))


def look_at(path: Path, device: str = "") -> Found:
    """Asks the target behind a port to describe itself, if the port is that of a board and is not in use."""
    vendor = _usb_vendor(path)
    if vendor not in VENDORS:
        return Found(path, device, None, "not asked: it is not a board that EPG knows")
    user = program_with(path)
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


def _usb_vendor(path: Path) -> str:
    """The vendor of the USB device with a serial port: four hexadecimal digits, or empty if there is none."""
    folder = (DEVICES / path.resolve().name / "device").resolve()
    for each in (folder, *folder.parents):
        try:
            return (each / "idVendor").read_text(encoding="ascii").strip()
        except OSError:
            continue  # an interface or a port of the device
    return ""
