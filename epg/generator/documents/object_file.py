# SPDX-License-Identifier: Apache-2.0
"""Object files of compilers: their variables, and copies with symbols added.

A compiler puts variables into writable sections.  A linker moves a section as a whole, so a symbol at its start and its
size give the addresses of all its variables in the program.  The code of the copy is that of the original.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Protocol

from epg.generator.dataclass import dataclass


class NotAnObjectFile(Exception):
    """The file cannot be read as an object file.  The message is a clause with the reason."""


@dataclass(frozen=True)
class Section:
    """A writable section: its variables.

    ``zero`` means that all of them are 0 when the program starts, ``shared`` that the linker may replace them by those
    of another object file.
    """

    number: int
    name: str
    size: int
    zero: bool
    shared: bool


@dataclass(frozen=True)
class ObjectVariable:
    """A variable: its name in the object file, and its place in its section.

    ``separate`` means that each thread has its own one.
    """

    name: str
    offset: int
    size: int
    separate: bool = False


class ObjectFile(Protocol):
    """An object file that a compiler has written."""

    def sections(self) -> list[Section]:
        """The sections that hold variables."""

    def has_constructors(self) -> bool:
        """True if code of this file runs before ``main()``."""

    def variables(self, section: int) -> list[ObjectVariable]:
        """The variables in a section, as far as the file names them, in the order of their places."""

    def common(self) -> list[ObjectVariable]:
        """The variables without a section, which the linker joins with those of other object files."""

    def with_symbols(self, symbols: Mapping[int, str], replaced: Mapping[str, str]) -> bytes:
        """A copy with a global symbol at the start of each section in ``symbols``.

        ``replaced`` are names of functions of other files, and the names of those that the copy calls instead.
        """
