# SPDX-License-Identifier: Apache-2.0
"""The serial ports of Linux."""

from __future__ import annotations

import os
from collections.abc import Iterator
from pathlib import Path

from epg.live.ports import UsbPort
from epg.live.ports.posix import PosixPort

DEVICES = Path("/sys/class/tty")
"""The folder in which Linux has a folder for each terminal."""
_BY_ID = Path("/dev/serial/by-id")


def open_device(path: Path, baud: int) -> PosixPort:
    return PosixPort(path, baud, program_with, "/dev/ttyACM0")


def list_ports() -> Iterator[UsbPort]:
    names = {link.resolve(): link.name for link in _BY_ID.glob("*")} if _BY_ID.is_dir() else {}
    for path in sorted(path for pattern in ("ttyACM*", "ttyUSB*") for path in Path("/dev").glob(pattern)):
        yield usb_port(path, names.get(path, ""))


def usb_port(path: Path, device: str = "") -> UsbPort:
    return UsbPort(path, device, _of_device(path, "idVendor"), _of_device(path, "serial"))


def _of_device(path: Path, name: str) -> str:
    """A property of the USB device with a serial port; empty if there is none."""
    folder = (DEVICES / path.resolve().name / "device").resolve()
    for each in (folder, *folder.parents):
        try:
            return (each / name).read_text(encoding="utf-8", errors="replace").strip()
        except OSError:
            continue  # an interface or a port of the device
    return ""


def program_with(path: Path) -> str:
    """Name and process of a program that has ``path`` open, as far as this user can see; else empty."""
    device = path.resolve()
    for folder in Path("/proc").glob("[0-9]*"):
        if folder.name == str(os.getpid()):
            continue
        try:
            if any(Path(os.readlink(file)) == device for file in (folder / "fd").iterdir()):
                return f"{(folder / 'comm').read_text().strip()} (process {folder.name})"
        except OSError:
            continue
    return ""
