# SPDX-License-Identifier: Apache-2.0
"""The common part of the importers of 20-sim's sources: each file of a folder can define a submodel."""

from __future__ import annotations

import re
from abc import abstractmethod
from pathlib import Path

from epg.generator.diagnostics import Diagnostics
from epg.generator.documents.source_file import SourceFile, read_source
from epg.generator.importers.importer import FoundModel, Importer
from epg.generator.models.c_code import CFile, parse_code
from epg.generator.models.folders import source_files
from epg.generator.models.link import is_program
from epg.generator.models.whole import is_whole

MOST_FILES = 400
"""The number of files of a folder that are read."""


class SubmodelSources(Importer):
    """Sources with the ``suffixes``.  ``part`` is found in the source of every submodel that is not whole."""

    rank = 20
    suffixes: tuple[str, ...]
    part: re.Pattern[str]

    @abstractmethod
    def found(self, code: CFile) -> FoundModel | None:
        """The submodel that ``code`` defines."""

    def find(self, folder: Path) -> list[FoundModel]:
        files = [file for file in source_files(folder, self.suffixes, 0) if not is_program(file)]
        candidates = (self.at(file, Diagnostics()) for file in files[:MOST_FILES])
        return [candidate for candidate in candidates if candidate is not None]

    def may_be(self, path: Path) -> bool:
        return path.suffix.lower() in self.suffixes

    def at(self, path: Path, diagnostics: Diagnostics) -> FoundModel | None:
        """The model whose entry points or class a source file defines, also if the file is not whole."""
        file = read_source(path, diagnostics)
        if file is None or "Calculate" not in file.text:
            return None
        return self.found(parse_code(file)) or (_broken(file) if self.part.search(file.code) else None)

    def considered(self, folder: Path) -> list[Path]:
        return source_files(folder, self.suffixes, 0)


def _broken(file: SourceFile) -> FoundModel | None:
    """A candidate for the file of a submodel that is not whole, which reports that when it is loaded.

    Without this candidate, EPG would silently use a ``tokens.xml`` beside the file instead.
    """

    def load(diagnostics: Diagnostics) -> None:
        is_whole(file, diagnostics)

    return None if is_whole(file, Diagnostics()) else FoundModel(file.path, load)
