# SPDX-License-Identifier: Apache-2.0
"""Serial ports: a module has the name of its system, ``sys.platform``, and the functions of :class:`PortsOfSystem`.

It is imported only when a port is opened or the ports are listed, so that EPG runs on systems that are not here.
"""

from __future__ import annotations

import importlib
import sys
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Protocol, cast


class PortError(Exception):
    """A port cannot be used; ``hint`` says how to change that."""

    def __init__(self, message: str, hint: str) -> None:
        super().__init__(message)
        self.hint = hint


@dataclass(frozen=True)
class UsbPort:
    """A serial port; its device's own name, vendor and serial number are empty if they are not known."""

    path: Path
    device: str = ""
    vendor: str = ""
    """Four hexadecimal digits."""
    serial: str = ""


class Device(Protocol):
    """An open serial port, which transfers plain bytes."""

    def read(self, seconds: float) -> bytes: ...
    def write(self, data: bytes, seconds: float) -> None: ...
    def close(self) -> None: ...


class PortsOfSystem(Protocol):
    """The functions of a system's module."""

    def open_device(self, path: Path, baud: int) -> Device: ...
    def list_ports(self) -> Iterable[UsbPort]: ...
    def usb_port(self, path: Path) -> UsbPort: ...
    def program_with(self, path: Path) -> str: ...


def system() -> PortsOfSystem:
    """The functions of this system.

    :raises PortError: there are none
    """
    try:
        return cast(PortsOfSystem, importlib.import_module(f"epg.live.ports.{sys.platform}"))
    except ImportError as error:
        raise PortError("EPG does not use ports on this system", "start it on Linux, macOS or Windows") from error


def gone(path: Path) -> PortError:
    return PortError(f"{path} is gone", "look at the cable and at the program, and connect again")


def full(path: Path) -> PortError:
    return PortError(f"{path} takes no bytes", "look at the cable; reset the board")


def missing(path: Path) -> PortError:
    return PortError(f"there is no {path}", "look at the cable, and at 'epg live', which lists the ports")


def wrong_rate(baud: int) -> PortError:
    return PortError(f"this computer's serial ports have no rate of {baud}", "use a rate such as 115200 or 921600")
