# SPDX-License-Identifier: Apache-2.0
"""FMUs for co-simulation of FMI 2.0 and 3.0 with sources, as archives or as folders."""

from __future__ import annotations

from functools import partial
from pathlib import Path

from epg.generator.diagnostics import Diagnostics
from epg.generator.importers.fmu.fmu_files import DESCRIPTION, SUFFIX, is_fmu_folder
from epg.generator.importers.importer import FoundModel, Importer
from epg.generator.models.folders import source_files
from epg.generator.models.model import Model


class Fmu(Importer):
    """An archive ``<name>.fmu``, or its unpacked folder."""

    rank = 30

    def find(self, folder: Path) -> list[FoundModel]:
        if is_fmu_folder(folder):
            return [FoundModel(folder / DESCRIPTION, partial(_load, folder))]
        return [FoundModel(file, partial(_load, file)) for file in source_files(folder, (SUFFIX,), 0)]

    def may_be(self, path: Path) -> bool:
        return path.suffix.lower() == SUFFIX or (path.name == DESCRIPTION and is_fmu_folder(path.parent))

    def at(self, path: Path, diagnostics: Diagnostics) -> FoundModel | None:
        return FoundModel(path, partial(_load, path.parent if path.name == DESCRIPTION else path))


def _load(path: Path, diagnostics: Diagnostics) -> Model | None:
    from epg.generator.importers.fmu.fmu import FmuSettings, load_fmu

    return load_fmu(path, diagnostics, FmuSettings())


IMPORTER = Fmu()
