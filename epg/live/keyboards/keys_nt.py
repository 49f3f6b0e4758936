# SPDX-License-Identifier: Apache-2.0
"""The keyboard of a console window of Windows, whose output must also understand escape sequences."""

from __future__ import annotations

import ctypes
import importlib
import sys
import time
from typing import Any

_OUTPUT = 0xFFFFFFF5  # STD_OUTPUT_HANDLE, -11
_SEQUENCES = 0x4  # ENABLE_VIRTUAL_TERMINAL_PROCESSING


class WindowsKeyboard:
    def __init__(self) -> None:
        self._keys: Any = importlib.import_module("msvcrt")

    def __enter__(self) -> WindowsKeyboard:
        kernel: Any = ctypes.CDLL("kernel32")
        kernel.GetStdHandle.restype = ctypes.c_void_p
        output, mode = ctypes.c_void_p(kernel.GetStdHandle(_OUTPUT)), ctypes.c_uint32()
        if kernel.GetConsoleMode(output, ctypes.byref(mode)):
            kernel.SetConsoleMode(output, mode.value | _SEQUENCES)
        sys.stdout.write("\x1b[2J")
        return self

    def pressed(self, seconds: float) -> str:
        end = time.monotonic() + seconds
        found = ""
        while not found and time.monotonic() < end:
            while self._keys.kbhit():
                key = self._keys.getwch()
                if key in "\0\xe0":  # an arrow or a function key, of which a second code follows
                    self._keys.getwch()
                else:
                    found += key
            if not found:
                time.sleep(0.005)
        return found

    def __exit__(self, *_: object) -> None:
        pass


def keyboard() -> WindowsKeyboard:
    return WindowsKeyboard()
