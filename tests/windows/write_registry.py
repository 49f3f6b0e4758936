# SPDX-License-Identifier: Apache-2.0
"""Run by Windows' Python: writes the keys of a board with two ports into the registry, and prints EPG's list of ports.

Windows has these keys for a USB device that consists of several parts.  Wine has none.
"""

import winreg

from epg.live.ports import win32

USB = r"SYSTEM\CurrentControlSet\Enum\USB"
PART = r"VID_2E8A&PID_000A&MI_00\6&2A3B4C5D&0&0000"
KEYS = (
    (r"HARDWARE\DEVICEMAP\SERIALCOMM", r"\Device\USBSER000", "COM12"),
    (rf"{USB}\VID_2E8A&PID_000A\E6614103E7174A21", "ParentIdPrefix", "6&2a3b4c5d&0"),
    (rf"{USB}\{PART}", "FriendlyName", "USB Serial Device (COM12)"),
    (rf"{USB}\{PART}\Device Parameters", "PortName", "COM12"),
)

for path, name, value in KEYS:
    with winreg.CreateKey(winreg.HKEY_LOCAL_MACHINE, path) as key:
        winreg.SetValueEx(key, name, 0, winreg.REG_SZ, value)
print(*win32.list_ports(), sep="\n")
