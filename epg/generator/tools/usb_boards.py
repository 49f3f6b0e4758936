# SPDX-License-Identifier: Apache-2.0
"""Lists boards and debug probes that are attached by USB.  This works on Linux, which has a folder for each device."""

from __future__ import annotations

from collections.abc import Collection
from pathlib import Path

from epg.generator.dataclass import dataclass

DEVICES = Path("/sys/bus/usb/devices")
"""The folder in which Linux has a folder for each USB device."""


@dataclass(frozen=True)
class UsbDevice:
    """A USB device.  ``id`` is its vendor and product: ``2e8a:000a``.  ``bus`` and ``address`` are its place."""

    id: str
    serial: str
    product: str
    bus: str
    address: str


def attached(ids: Collection[str]) -> list[UsbDevice] | None:
    """The attached devices with these ids, or None if this operating system does not list them."""
    if not DEVICES.is_dir():
        return None
    devices = (_device(folder) for folder in sorted(DEVICES.iterdir()))
    return [device for device in devices if device.id in ids]


def _device(folder: Path) -> UsbDevice:
    def text(name: str) -> str:
        try:
            return (folder / name).read_text(encoding="utf-8", errors="replace").strip()
        except OSError:  # an interface has no vendor, and a device that was pulled has no folder
            return ""

    id = f"{text('idVendor')}:{text('idProduct')}"
    return UsbDevice(id, text("serial"), text("product"), text("busnum"), text("devnum"))
