# SPDX-License-Identifier: Apache-2.0
"""Serial ports of other systems: what EPG does with the answers of Windows' functions, its registry, and ``ioreg``."""

from __future__ import annotations

import fcntl
import os
from collections.abc import Mapping
from pathlib import Path, PureWindowsPath
from typing import Any

import pytest

from epg.live.ports import PortError, UsbPort, darwin, linux, registry, win32

TIOCGEXCL = 0x80045440
"""A request of Linux: is a terminal claimed by one program?"""


class Kernel:
    """Functions of Windows for one port.  ``refusal`` is the error of its opening."""

    def __init__(self, refusal: int = 0, incoming: bytes = b"", takes: int = 3) -> None:
        self.refusal, self.incoming, self.takes = refusal, incoming, takes
        self.opened, self.sent, self.unplugged, self.closed = "", b"", False, 0
        self.count = 0
        self.rates: list[int] = []

    def error(self) -> int:
        return self.refusal

    def CreateFileW(self, name: str, *_: object) -> int:
        self.opened = name
        return win32._INVALID or 0 if self.refusal else 1

    def SetCommState(self, _: int, state: Any) -> int:
        self.rates.append(state._obj.baud)
        return 1

    def ReadFile(self, _: int, buffer: Any, size: int, *__: object) -> int:
        data, self.incoming = self.incoming[:size], self.incoming[size:]
        buffer[: len(data)] = data
        self.count = len(data)
        self.refusal = 22  # "the device does not recognise the command": it was unplugged
        return int(not self.unplugged)

    def ClearCommError(self, _: int, __: object, queues: Any) -> int:
        queues._obj.input = len(self.incoming)
        return 1

    def WriteFile(self, _: int, data: bytes, size: int, *__: object) -> int:
        self.count = min(size, self.takes)
        self.sent += data[: self.count]
        return 1

    def GetOverlappedResult(self, _: int, __: object, count: Any, ___: int) -> int:
        count._obj.value = self.count
        return 1

    def CloseHandle(self, _: int) -> None:
        self.closed += 1

    def __getattr__(self, _: str) -> Any:
        return lambda *__: 1


def open_port(kernel: Kernel, name: str = "COM3") -> win32.ComPort:
    return win32.ComPort(PureWindowsPath(name), 115200, kernel)


@pytest.mark.parametrize(
    ("name", "opened"), [("COM3", "COM3"), ("com4", "COM4"), (r"\\.\COM12", "COM12"), ("//./COM300", "COM300")]
)
def test_names_of_ports(name: str, opened: str) -> None:
    kernel = Kernel()
    open_port(kernel, name).close()
    assert kernel.opened == rf"\\.\{opened}" and kernel.rates == [115200]


@pytest.mark.parametrize("name", ["COM", "COM0", "LPT1", r"C:\COM3", "/dev/ttyACM0", "udp:7000", "COM٣"])
def test_other_names_are_refused(name: str) -> None:
    with pytest.raises(PortError, match="is not a serial port"):
        open_port(Kernel(), name)


@pytest.mark.parametrize(
    ("error", "message"),
    [
        (5, "another program has COM3"),
        (32, "another program has COM3"),
        (2, "there is no COM3"),
        (1167, "COM3 cannot be opened: error 1167 of Windows"),
    ],
)
def test_a_port_that_cannot_be_opened(error: int, message: str) -> None:
    with pytest.raises(PortError, match=message) as found:
        open_port(Kernel(error))
    assert found.value.hint
    if error == 5:
        assert "another 'epg live'" in found.value.hint


def test_bytes_are_read_and_written() -> None:
    kernel = Kernel(incoming=b"\0\x1a\xff")
    port = open_port(kernel)
    assert port.read(0.1) == b"\0\x1a\xff"
    assert port.read(0.1) == b""
    port.write(b"12345678", 1.0)
    assert kernel.sent == b"12345678"
    port.close()
    assert kernel.closed == 3  # the port and two events


def test_a_port_that_takes_nothing_and_one_that_is_gone() -> None:
    kernel = Kernel(takes=0)
    port = open_port(kernel)
    with pytest.raises(PortError, match="COM3 takes no bytes"):
        port.write(b"1", 1.0)
    kernel.unplugged = True
    with pytest.raises(PortError, match="COM3 is gone"):
        port.read(0.1)


# The registry

Tree = Mapping[str, Mapping[str, str]]
TREE: Tree = {
    r"HARDWARE\DEVICEMAP\SERIALCOMM": {
        r"\Device\Serial0": "COM1",
        r"\Device\USBSER000": "COM12",
        r"\Device\USBSER001": "COM5",
        r"\Device\USBSER002": "COM7",
    },
    r"SYSTEM\CurrentControlSet\Enum\USB\VID_2E8A&PID_000A\E6614103E7174A21": {"ParentIdPrefix": "6&2a3b4c5d&0"},
    r"SYSTEM\CurrentControlSet\Enum\USB\VID_2E8A&PID_000A&MI_00\6&2A3B4C5D&0&0000": {
        "FriendlyName": "USB Serial Device (COM12)"
    },
    r"SYSTEM\CurrentControlSet\Enum\USB\VID_2E8A&PID_000A&MI_00\6&2A3B4C5D&0&0000\Device Parameters": {
        "PortName": "COM12"
    },
    r"SYSTEM\CurrentControlSet\Enum\USB\VID_2FE3&PID_0100\0123456789ABCDEF": {"FriendlyName": "Zephyr (COM5)"},
    r"SYSTEM\CurrentControlSet\Enum\USB\VID_2FE3&PID_0100\0123456789ABCDEF\Device Parameters": {"PortName": "COM5"},
    r"SYSTEM\CurrentControlSet\Enum\USB\VID_1A86&PID_7523\5&1C2D3E4F&0&2\Device Parameters": {"PortName": "COM7"},
    r"SYSTEM\CurrentControlSet\Enum\USB\VID_0483&PID_374B\0671FF\Device Parameters": {"PortName": "COM9"},
    r"SYSTEM\CurrentControlSet\Enum\USB\ROOT_HUB30\4&1": {},
}


class Registry:
    """Like the module ``winreg``."""

    HKEY_LOCAL_MACHINE = 0

    def __init__(self, tree: Tree) -> None:
        self._tree = tree

    class _Key(str):
        def __enter__(self) -> Registry._Key:
            return self

        def __exit__(self, *_: object) -> None:
            pass

    def OpenKey(self, _: int, path: str) -> Registry._Key:
        if not any(key == path or key.startswith(f"{path}\\") for key in self._tree):
            raise OSError(2, "there is none")
        return self._Key(path)

    def EnumKey(self, key: str, index: int) -> str:
        below = [name[len(key) + 1 :].split("\\")[0] for name in self._tree if name.startswith(f"{key}\\")]
        return self._item(list(dict.fromkeys(below)), index)

    def EnumValue(self, key: str, index: int) -> tuple[str, str, int]:
        return (*self._item(list(self._tree.get(key, {}).items()), index), 1)

    @staticmethod
    def _item(items: list[Any], index: int) -> Any:
        if index >= len(items):
            raise OSError(259, "no more")
        return items[index]


def test_ports_of_the_registry() -> None:
    """The port that was unplugged, COM9, is not there; the serial number of a composite device is its parent's."""
    assert list(registry.ports_of(Registry(TREE))) == [
        UsbPort(Path("COM1")),
        UsbPort(Path("COM5"), "Zephyr (COM5)", "2fe3", "0123456789ABCDEF"),
        UsbPort(Path("COM7"), "", "1a86", ""),
        UsbPort(Path("COM12"), "USB Serial Device (COM12)", "2e8a", "E6614103E7174A21"),
    ]


def test_a_computer_without_ports() -> None:
    assert list(registry.ports_of(Registry({}))) == []


# macOS

IOREG = """\
+-o Pico@01100000  <class IOUSBHostDevice, id 0x100000a2c, registered, matched, active, busy 0 (12 ms), retain 27>
  | {
  |   "idVendor" = 11914
  |   "USB Product Name" = "Pico"
  |   "USB Serial Number" = "E6614103E7174A21"
  | }
  |
  +-o AppleUSBCDCCompositeDevice  <class AppleUSBCDCCompositeDevice, id 0x100000a30, !registered, !matched, active>
  | {
  |   "IOClass" = "AppleUSBCDCCompositeDevice"
  | }
  +-o CDC Data@1  <class IOUSBHostInterface, id 0x100000a31, registered, matched, active, busy 0 (5 ms), retain 9>
    | {
    |   "bInterfaceNumber" = 1
    | }
    +-o AppleUSBACMData  <class AppleUSBACMData, id 0x100000a35, registered, matched, active, busy 0 (2 ms), retain 8>
      +-o IOSerialBSDClient  <class IOSerialBSDClient, id 0x100000a36, registered, matched, active, busy 0, retain 5>
          {
            "IOTTYDevice" = "usbmodem1101"
            "IOCalloutDevice" = "/dev/cu.usbmodem1101"
            "IODialinDevice" = "/dev/tty.usbmodem1101"
          }
+-o Hub@02100000  <class IOUSBHostDevice, id 0x100000b2c, registered, matched, active, busy 0 (12 ms), retain 27>
  | {
  |   "idVendor" = 1507
  | }
"""


def test_ports_of_ioreg() -> None:
    port = UsbPort(Path("/dev/cu.usbmodem1101"), "Pico", "2e8a", "E6614103E7174A21")
    assert list(darwin.ports_of(IOREG)) == [port]
    assert list(darwin.ports_of("")) == []


def test_a_port_behind_a_hub_is_listed_once(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A program with the name of ``ioreg`` that knows a hub, and then its device once more."""
    (tmp_path / "ioreg").write_text(f"#!/bin/sh\ncat <<'END'\n{IOREG}{IOREG}END\n")
    (tmp_path / "ioreg").chmod(0o755)
    monkeypatch.setenv("PATH", str(tmp_path), prepend=os.pathsep)
    path = Path("/dev/cu.usbmodem1101")
    assert list(darwin.list_ports()) == [darwin.usb_port(path)] == [UsbPort(path, "Pico", "2e8a", "E6614103E7174A21")]


def test_rates_of_a_terminal_of_macos() -> None:
    """A rate that POSIX does not have is set by another request, which a terminal without wires refuses."""
    ours, theirs = os.openpty()
    name = Path(os.ttyname(theirs))
    darwin.open_device(name, 115200).close()
    with pytest.raises(PortError, match="have no rate of 12345"):
        darwin.open_device(name, 12345)
    os.close(ours)
    os.close(theirs)


def test_a_pseudo_terminal_can_be_opened_again() -> None:
    """Its other end stays open, so a claim to be alone would outlive the port: only root could open it again."""
    ours, theirs = os.openpty()
    name = Path(os.ttyname(theirs))
    os.close(theirs)
    for _ in range(2):
        linux.open_device(name, 115200).close()
        again = os.open(name, os.O_RDWR | os.O_NOCTTY)
        assert fcntl.ioctl(again, TIOCGEXCL, bytes(4)) == bytes(4)
        os.close(again)
    os.close(ours)
