# SPDX-License-Identifier: Apache-2.0
"""Lists boards and debug probes that are attached by USB: on Linux, which has a folder for each device, and Windows."""

from __future__ import annotations

import re
from collections.abc import Collection
from pathlib import Path

from epg.generator.dataclass import dataclass
from epg.generator.system import here

DEVICES = Path("/sys/bus/usb/devices")
"""The folder in which Linux has a folder for each USB device."""
NOT_LISTED = "EPG lists attached boards on Linux and Windows only"
"""Says why :func:`attached` returns None."""


@dataclass(frozen=True)
class UsbDevice:
    """A USB device.  ``id`` is its vendor and product: ``2e8a:000a``.

    ``product``, and its place, ``bus`` and ``address``, are empty on Windows.
    """

    id: str
    serial: str
    product: str
    bus: str
    address: str


# The instance id of a device.  Its parts have "&MI_" behind the product; Windows makes serial numbers with "&".
_INSTANCE = re.compile(r"USB\\VID_([0-9A-F]{4})&PID_([0-9A-F]{4})\\([^&\\]+)", re.IGNORECASE)


def attached(ids: Collection[str]) -> list[UsbDevice] | None:
    """The attached devices with these ids, or None if this operating system does not list them."""
    if DEVICES.is_dir():
        devices = [_device(folder) for folder in sorted(DEVICES.iterdir())]
    else:
        names = here.usb_devices()
        if names is None:
            return None
        found = [match for name in sorted(names) if (match := _INSTANCE.fullmatch(name))]
        devices = [UsbDevice(f"{match[1]}:{match[2]}".lower(), match[3], "", "", "") for match in found]
    return [device for device in devices if device.id in ids]


def _device(folder: Path) -> UsbDevice:
    def text(name: str) -> str:
        try:
            return (folder / name).read_text(encoding="utf-8", errors="replace").strip()
        except OSError:  # an interface has no vendor, and a device that was pulled has no folder
            return ""

    id = f"{text('idVendor')}:{text('idProduct')}"
    return UsbDevice(id, text("serial"), text("product"), text("busnum"), text("devnum"))
