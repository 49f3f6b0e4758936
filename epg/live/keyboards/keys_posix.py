# SPDX-License-Identifier: Apache-2.0
"""The keyboard of a terminal of Linux and macOS."""

from __future__ import annotations

import os
import re
import select
import sys
import termios
import tty

_SEQUENCE = re.compile(r"\x1b([\[O][0-?]*[ -/]*[@-~]?)?")  # of an arrow or a function key: ECMA-48, 5.4


class PosixKeyboard:
    def is_here(self) -> bool:
        return sys.stdin.isatty() and sys.stdout.isatty()

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
        read = os.read(self._file, 1024).decode("utf-8", "ignore")
        return _SEQUENCE.sub("", read) if read else "\x04"

    def __exit__(self, *_: object) -> None:
        try:
            termios.tcsetattr(self._file, termios.TCSADRAIN, self._before)
        except termios.error as error:
            raise OSError(*error.args) from error


def keyboard() -> PosixKeyboard:
    return PosixKeyboard()
