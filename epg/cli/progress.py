# SPDX-License-Identifier: Apache-2.0
"""The terminal of a command that takes long: it shows the progress, and its user can ask for the end."""

from __future__ import annotations

import signal
import sys

from epg.generator.system import here


class ProgressLine:
    """One line on the terminal that each message overwrites.  Prints nothing if the output goes to a file."""

    def __init__(self, quiet: bool) -> None:
        self.active = not quiet and sys.stderr.isatty()

    def __call__(self, message: str) -> None:
        if self.active:
            sys.stderr.write(f"\r\x1b[K{message}")
            sys.stderr.flush()

    def done(self) -> None:
        if self.active:
            sys.stderr.write("\r\x1b[K")
            sys.stderr.flush()


class StopRequest:
    """``asked``, and True when called, after Ctrl-C, SIGTERM, or the end of the terminal.

    The command then ends normally, with complete files.
    """

    def __init__(self) -> None:
        self.asked = False

    def __enter__(self) -> StopRequest:
        ends = [number for number in here.end_signals() if signal.getsignal(number) is not signal.SIG_IGN]  # by `nohup`
        numbers = [signal.SIGINT, *ends]
        self._before = {number: signal.signal(number, self._ask) for number in numbers}
        return self

    def _ask(self, number: int, frame: object) -> None:
        self.asked = True

    def __call__(self) -> bool:
        return self.asked

    def __exit__(self, *_: object) -> None:
        for number, handler in self._before.items():
            signal.signal(number, handler)
