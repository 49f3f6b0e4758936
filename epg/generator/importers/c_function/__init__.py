# SPDX-License-Identifier: Apache-2.0
"""Exports of 20-sim's C function target, and the C sources of its FMU target."""

from __future__ import annotations

import re
from functools import partial
from pathlib import Path

from epg.generator.diagnostics import Diagnostics
from epg.generator.documents.source_file import read_source
from epg.generator.importers.c_function import c_function
from epg.generator.importers.importer import FoundModel, NearlyModel
from epg.generator.importers.submodel_sources import MOST_FILES, SubmodelSources
from epg.generator.models.c_code import CFile, parse_code
from epg.generator.models.folders import source_files

SUBMODEL = "functions ...InitializeSubmodel() and ...CalculateSubmodel()"
EQUATIONS = "CalculateDynamic"  # part of the name of a function that is in every C export
EXPORT_AGAIN = (
    "generate the code of the submodel in 20-sim again (Tools > Real Time Toolbox > C-Code Generation, 'C function') "
    "into a separate folder, and name this folder"
)


class CFunction(SubmodelSources):
    """A ``.c`` file with the entry points of a submodel, under any name."""

    suffixes = c_function.SUFFIXES
    part = re.compile(r"\bvoid\s+\w*(?:Initialize|Calculate)Submodel\w*\s*\(", re.ASCII)

    def found(self, code: CFile) -> FoundModel | None:
        if not c_function.is_c_function(code):
            return None
        return FoundModel(code.file.path, partial(c_function.load_c_function, code))

    def nearly(self, path: Path) -> NearlyModel | None:
        """Users copy only a part of an export."""
        if path.is_file():
            part = _part_of_export([path])
            reason = f": it has equations of a 20-sim export, but not its {SUBMODEL}"
        else:
            part = _part_of_export(source_files(path, self.suffixes, 1))
            reason = f": '{part}' has equations of a 20-sim export, but no file has its {SUBMODEL}"
        return NearlyModel(reason, EXPORT_AGAIN) if part else None


def _part_of_export(files: list[Path]) -> str:
    """The name of the first file that has equations of a C export; empty if there is none."""
    for path in files[:MOST_FILES]:
        file = read_source(path, Diagnostics()) if path.suffix.lower() in c_function.SUFFIXES else None
        if file and EQUATIONS in file.text and any(EQUATIONS in code.name for code in parse_code(file).functions):
            return path.name
    return ""


IMPORTER = CFunction()
