# SPDX-License-Identifier: Apache-2.0
"""The serial ports of macOS, as ``ioreg`` lists them.  No Mac has run this."""

from __future__ import annotations

import fcntl
import re
import struct
import subprocess
import termios
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from epg.live.ports import UsbPort, wrong_rate
from epg.live.ports.posix import PosixPort

_IOSSIOSPEED = 0x80085402  # _IOW('T', 2, speed_t) of IOKit
_NODE = re.compile(r"^(?P<depth>[ |]*)\+-o (?P<name>.*?)(?:@\S+)?  <")
_PROPERTY = re.compile(r'^[ |]*"(?P<name>[^"]+)" = (?P<value>.*?)\s*$')


class MacPort(PosixPort):
    """A port that has other rates than those of POSIX, which end at 230400."""

    def _set(self, attributes: list[Any], baud: int) -> None:
        posix = hasattr(termios, f"B{baud}")
        super()._set(attributes, baud if posix else 9600)
        if not posix:
            try:
                fcntl.ioctl(self._file, _IOSSIOSPEED, struct.pack("L", baud))
            except OSError as error:
                raise wrong_rate(baud) from error


def open_device(path: Path, baud: int) -> PosixPort:
    return MacPort(path, baud, program_with, "/dev/cu.usbmodem1101")


def list_ports() -> Iterator[UsbPort]:
    command = ["ioreg", "-r", "-c", "IOUSBHostDevice", "-l", "-w", "0"]
    try:
        done = subprocess.run(command, capture_output=True, text=True, timeout=10, check=False)
    except (OSError, subprocess.SubprocessError):
        return
    yield from {port.path: port for port in ports_of(done.stdout)}.values()  # ports behind a hub come twice


def usb_port(path: Path) -> UsbPort:
    return next((port for port in list_ports() if port.path == path), UsbPort(path))


def program_with(path: Path) -> str:
    """Empty: macOS does not tell it."""
    return ""


def ports_of(text: str) -> Iterator[UsbPort]:
    """The ports in an output of ``ioreg``: a node without a property takes it from the node above."""
    nodes: list[tuple[int, dict[str, str]]] = []
    for line in text.splitlines():
        node = _NODE.match(line)
        if node:
            depth = len(node["depth"])
            while nodes and nodes[-1][0] >= depth:
                nodes.pop()
            nodes.append((depth, dict(nodes[-1][1]) if nodes else {}))
            continue
        found = _PROPERTY.match(line)
        if found and nodes:
            values = nodes[-1][1]
            values[found["name"]] = found["value"].strip('"')
            if found["name"] == "IOCalloutDevice":
                vendor = f"{int(values['idVendor']):04x}" if values.get("idVendor", "").isdecimal() else ""
                device = values.get("USB Product Name", "")
                yield UsbPort(Path(values["IOCalloutDevice"]), device, vendor, values.get("USB Serial Number", ""))
