# SPDX-License-Identifier: Apache-2.0
"""Questions and answers as lines of text: on a terminal, through a pipe, or from a file with answers.

>>> import io
>>> console = Console(io.StringIO("pa\\n"), io.StringIO())
>>> console.ask("component", "")
'pa'
"""

from __future__ import annotations

import shutil
import textwrap
from collections.abc import Iterable, Sequence
from typing import TextIO

NARROW = 80
"""The number of columns if it is not known."""
WIDE = 160
"""The largest number of columns that is used: longer lines are hard to read."""


class Ended(Exception):
    """There are no more answers."""


class Console:
    """``input`` and ``output`` need not be a terminal.  If they are not, answers are also written to the output."""

    def __init__(self, input: TextIO, output: TextIO) -> None:
        self._input, self._output = input, output
        self.is_terminal = input.isatty() and output.isatty()
        columns = shutil.get_terminal_size((NARROW, 24)).columns if output.isatty() else NARROW
        self.width = max(40, min(columns, WIDE))
        self._over = 0  # number of characters on the line that the next output replaces

    def say(self, text: str = "") -> None:
        """Prints lines as they are."""
        self.clear()
        self._write(f"{_visible(text)}\n")

    def fill(self, text: str, indent: str = "") -> None:
        """Prints a paragraph, wrapped."""
        self.say(textwrap.fill(text, self.width, initial_indent=indent, subsequent_indent=indent))

    def items(self, words: Iterable[str], indent: str = "") -> None:
        """Prints words side by side.  A word that contains a blank is not broken there."""
        text = "  ".join(word.replace(" ", "\0") for word in words)
        filled = textwrap.fill(text, self.width, initial_indent=indent, subsequent_indent=indent)
        self.say(filled.replace("\0", " "))

    def table(self, header: Sequence[str], rows: Iterable[Sequence[str]]) -> None:
        """Prints columns; only the last one is wrapped."""
        listed = [tuple(row) for row in rows]
        lines = [*([tuple(header)] if any(header) else []), *listed]
        if not lines:
            return
        widths = [max(len(line[column]) for line in lines) for column in range(len(lines[0]) - 1)]
        before = sum(widths) + 2 * len(widths)
        left = max(self.width - before, 20)
        for line in lines:
            start = "".join(f"{cell:<{width}}  " for cell, width in zip(line, widths))
            rest = textwrap.wrap(line[-1], left) or [""]
            self.say((start + rest[0]).rstrip())
            for more in rest[1:]:
                self.say(" " * before + more)

    def over(self, text: str) -> None:
        """Shows ``text`` on a line that the next output replaces.  Does nothing if the output is not a terminal."""
        if self._output.isatty():
            shown = _visible(text)[: self.width - 1]
            self._write("\r" + shown + " " * (self._over - len(shown)))
            self._over = len(shown)

    def clear(self) -> None:
        """Removes the text that :meth:`over` has shown."""
        if self._over:
            self._write("\r" + " " * self._over + "\r")
            self._over = 0

    def ask(self, question: str, default: str) -> str:
        """The answer without blanks around it; ``default`` if it is empty.  Raises Ended at the end of the input."""
        self.clear()
        self._write(_visible(f"{question} [{default}]: " if default else f"{question}: "))
        line = self._input.readline()
        if not line:
            self._write("\n")
            raise Ended
        if not self.is_terminal:
            self._write(_visible(line.rstrip("\n")) + "\n")
        return line.strip() or default

    def agree(self, question: str, default: str = "y") -> bool:
        """Asks until the answer is yes or no.  Returns True for yes.  Enter means ``default``."""
        while True:
            answer = self.ask(f"{question} (y/n)", default).casefold()
            if answer in ("y", "yes", "n", "no"):
                return answer.startswith("y")
            self.say("y or n, please.")

    def _write(self, text: str) -> None:
        """Writes ``text``, with '?' for each character that the output's encoding does not have."""
        encoding = getattr(self._output, "encoding", None) or "utf-8"
        self._output.write(text.encode(encoding, "replace").decode(encoding))
        self._output.flush()


def _visible(text: str) -> str:
    """``text`` with '?' for control characters: a terminal would obey escape sequences in the text of a file."""
    return "".join(char if char.isprintable() or char in "\n\t" else "?" for char in text)
