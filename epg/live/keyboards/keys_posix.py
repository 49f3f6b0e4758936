# SPDX-License-Identifier: Apache-2.0
"""The keyboard of a terminal of Linux and macOS."""

from __future__ import annotations

import os
import select
import sys
import termios
import tty


class PosixKeyboard:
    def __enter__(self) -> PosixKeyboard:
        self._file = sys.stdin.fileno()
        try:
            self._before = termios.tcgetattr(self._file)
            tty.setraw(self._file)
        except termios.error as error:
            raise OSError(*error.args) from error
        sys.stdout.write("\x1b[2J")
        return self

    def pressed(self, seconds: float) -> str:
        if not select.select([self._file], [], [], seconds)[0]:
            return ""
        return os.read(self._file, 1024).decode("utf-8", "ignore") or "\x04"

    def __exit__(self, *_: object) -> None:
        try:
            termios.tcsetattr(self._file, termios.TCSADRAIN, self._before)
        except termios.error as error:
            raise OSError(*error.args) from error


def keyboard() -> PosixKeyboard:
    return PosixKeyboard()
