# SPDX-License-Identifier: Apache-2.0
"""The serial ports in Windows' registry.  ``registry`` is the module ``winreg``, or one with the same functions."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

from epg.live.ports import UsbPort

_SERIALCOMM = r"HARDWARE\DEVICEMAP\SERIALCOMM"
_USB = r"SYSTEM\CurrentControlSet\Enum\USB"


def ports_of(registry: Any) -> Iterator[UsbPort]:
    """The ports of SERIALCOMM with what the registry has about their USB devices."""
    known = {port.path: port for port in _usb_ports(registry)}
    names = {str(value) for _, value in _values(registry, _SERIALCOMM)}
    for name in sorted(names, key=lambda name: (len(name), name)):
        yield known.get(Path(name), UsbPort(Path(name)))


def _usb_ports(registry: Any) -> Iterator[UsbPort]:
    """Also those of devices that were unplugged.  The parts of a composite device have no serial number."""
    devices = [(kind, each) for kind in _keys(registry, _USB) for each in _keys(registry, rf"{_USB}\{kind}")]
    parents = {}  # of a composite device's parts: the beginning of their names, and the serial number
    for kind, each in devices:
        prefix = dict(_values(registry, rf"{_USB}\{kind}\{each}")).get("ParentIdPrefix")
        if prefix:
            parents[str(prefix).lower()] = each
    for kind, each in devices:
        key = rf"{_USB}\{kind}\{each}"
        name = dict(_values(registry, rf"{key}\Device Parameters")).get("PortName")
        vendor = re.match(r"VID_([0-9A-F]{4})", kind, re.IGNORECASE)
        if name and vendor:
            serial = parents.get(each.lower().rpartition("&")[0], "") if "&MI_" in kind.upper() else each
            device = str(dict(_values(registry, key)).get("FriendlyName", ""))
            # Windows itself makes a name with '&' for a device without a serial number.
            yield UsbPort(Path(str(name)), device, vendor[1].lower(), "" if "&" in serial else serial)


def _keys(registry: Any, path: str) -> list[str]:
    return _enumerate(registry, path, registry.EnumKey)


def _values(registry: Any, path: str) -> list[tuple[str, object]]:
    return [(name, value) for name, value, _ in _enumerate(registry, path, registry.EnumValue)]


def _enumerate(registry: Any, path: str, function: Callable[[Any, int], Any]) -> list[Any]:
    """Everything below a key; nothing if it does not exist or must not be read."""
    found: list[Any] = []
    try:
        with registry.OpenKey(registry.HKEY_LOCAL_MACHINE, path) as key:
            while True:
                found.append(function(key, len(found)))
    except OSError:  # the end
        return found
