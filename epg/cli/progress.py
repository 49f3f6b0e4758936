# SPDX-License-Identifier: Apache-2.0
"""How far a command has come, for whoever watches it in a terminal."""

from __future__ import annotations

import sys


class Progress:
    """A line on a terminal that is written over; nothing where the output goes to a file."""

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
