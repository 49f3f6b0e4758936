# SPDX-License-Identifier: Apache-2.0
"""The parts of a model's own code that several importers describe."""

from __future__ import annotations

from pathlib import Path

from epg.generator.dataclass import dataclass


@dataclass(frozen=True)
class SourceRange:
    """The place of a parameter's value in the sources.  ``start`` and ``end`` are offsets into the text of ``file``."""

    file: Path
    start: int
    end: int


@dataclass(frozen=True)
class GlobalVariable:
    """A variable of the export that the wrapper resets to its initial value at each start.

    ``count`` is the number of elements of an array, which becomes zero.  It is 0 for a scalar, which becomes ``value``.
    ``changed`` means that ``value`` is not that of the export.
    """

    name: str
    type: str  # of C: "double", "int", "char"
    count: int
    value: str
    changed: bool = False
