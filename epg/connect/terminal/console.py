# SPDX-License-Identifier: Apache-2.0
"""Questions and answers as lines of text: on a terminal, through a pipe, from a file of answers.

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
"""Columns where nobody says how many there are."""
WIDE = 160
"""More columns than these make lines that nobody reads."""


class Ended(Exception):
    """There are no more answers."""


class Console:
    """``input`` and ``output`` need not be a terminal; answers are shown in the output then, as if they were typed."""

    def __init__(self, input: TextIO, output: TextIO) -> None:
        self._input, self._output = input, output
        self.is_terminal = input.isatty() and output.isatty()
        columns = shutil.get_terminal_size((NARROW, 24)).columns if output.isatty() else NARROW
        self.width = max(40, min(columns, WIDE))
        self._over = 0  # characters of a line that is written over

    def say(self, text: str = "") -> None:
        """Prints lines as they are."""
        self.clear()
        self._write(f"{_visible(text)}\n")

    def fill(self, text: str, indent: str = "") -> None:
        """Prints a paragraph, wrapped."""
        self.say(textwrap.fill(text, self.width, initial_indent=indent, subsequent_indent=indent))

    def items(self, words: Iterable[str], indent: str = "") -> None:
        """Prints words beside each other, none of them broken at a blank."""
        text = "  ".join(word.replace(" ", "\0") for word in words)
        filled = textwrap.fill(text, self.width, initial_indent=indent, subsequent_indent=indent)
        self.say(filled.replace("\0", " "))

    def table(self, header: Sequence[str], rows: Iterable[Sequence[str]]) -> None:
        """Prints columns; the last one is wrapped where the line ends."""
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
        """Shows ``text`` on a line that the next output replaces; nothing where nobody watches."""
        if self._output.isatty():
            shown = _visible(text)[: self.width - 1]
            self._write("\r" + shown + " " * (self._over - len(shown)))
            self._over = len(shown)

    def clear(self) -> None:
        """Takes away what :meth:`over` has shown."""
        if self._over:
            self._write("\r" + " " * self._over + "\r")
            self._over = 0

    def ask(self, question: str, default: str) -> str:
        """The answer, without blanks around it; ``default`` when it is empty.  Raises Ended at the end of the input."""
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
        """Whether the answer is yes; Enter means ``default``."""
        while True:
            answer = self.ask(f"{question} (y/n)", default).casefold()
            if answer in ("y", "yes", "n", "no"):
                return answer.startswith("y")
            self.say("y or n, please.")

    def _write(self, text: str) -> None:
        """Writes what the output's encoding has, and '?' for the rest."""
        encoding = getattr(self._output, "encoding", None) or "utf-8"
        self._output.write(text.encode(encoding, "replace").decode(encoding))
        self._output.flush()


def _visible(text: str) -> str:
    """Text of files without what a terminal would obey: escape sequences, movements of the cursor."""
    return "".join(char if char.isprintable() or char in "\n\t" else "?" for char in text)
