# SPDX-License-Identifier: Apache-2.0
"""The keyboard of a console of Windows, whose output must also understand escape sequences.

The module msvcrt is not used: its getwch() does not tell the letter "à" from the first code of an arrow key.
"""

from __future__ import annotations

import ctypes
import errno
import struct
import sys
from typing import Any

_HANDLES = (-10, -11)  # STD_INPUT_HANDLE, STD_OUTPUT_HANDLE
_KEYS = 0x80  # ENABLE_EXTENDED_FLAGS alone: Ctrl-C is a key, and a selection by the mouse does not stop the output
_SEQUENCES = 0x1 | 0x4  # ENABLE_PROCESSED_OUTPUT, ENABLE_VIRTUAL_TERMINAL_PROCESSING
_RECORD = struct.Struct("<HxxiH4xH4x")  # INPUT_RECORD: kind, pressed, repetitions, character (0: an arrow key)
_KEY_EVENT, _TIMEOUT, _MOST = 1, 258, 64


class WindowsKeyboard:
    def __init__(self) -> None:
        self._kernel: Any = ctypes.CDLL("kernel32")
        self._kernel.GetStdHandle.restype = ctypes.c_void_p
        self._input, self._output = (ctypes.c_void_p(self._kernel.GetStdHandle(number)) for number in _HANDLES)

    def is_here(self) -> bool:
        return None not in self._modes()  # Python takes NUL for a terminal, too

    def __enter__(self) -> WindowsKeyboard:
        self._before = self._modes()
        self._set(_KEYS, (self._before[1] or 0) | _SEQUENCES)
        sys.stdout.write("\x1b[2J")
        return self

    def pressed(self, seconds: float) -> str:
        if self._kernel.WaitForSingleObject(self._input, round(1000 * seconds)) == _TIMEOUT:
            return ""
        records, count = ctypes.create_string_buffer(_MOST * _RECORD.size), ctypes.c_uint32()
        if not self._kernel.ReadConsoleInputW(self._input, records, _MOST, ctypes.byref(count)):
            raise OSError(errno.EIO, "the console has closed")
        read = _RECORD.iter_unpack(records.raw[: count.value * _RECORD.size])
        return "".join(chr(code) * times for kind, down, times, code in read if kind == _KEY_EVENT and down and code)

    def __exit__(self, *_: object) -> None:
        sys.stdout.flush()
        self._set(*self._before)

    def _modes(self) -> list[int | None]:
        """The modes of input and output; None is that of something else than a console."""
        modes = [(handle, ctypes.c_uint32()) for handle in (self._input, self._output)]
        return [
            mode.value if self._kernel.GetConsoleMode(handle, ctypes.byref(mode)) else None for handle, mode in modes
        ]

    def _set(self, *modes: int | None) -> None:
        for handle, mode in zip((self._input, self._output), modes, strict=True):
            self._kernel.SetConsoleMode(handle, mode or 0)


def keyboard() -> WindowsKeyboard:
    return WindowsKeyboard()
