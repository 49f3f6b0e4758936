# SPDX-License-Identifier: Apache-2.0
"""Shows the progress of a command in the terminal."""

from __future__ import annotations

import sys


class Progress:
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
