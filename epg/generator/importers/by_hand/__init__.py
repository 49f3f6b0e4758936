# SPDX-License-Identifier: Apache-2.0
"""Controllers written by hand: a ``model.yaml`` and the user's own sources."""

from __future__ import annotations

from functools import partial
from pathlib import Path

from epg.generator.diagnostics import Diagnostics
from epg.generator.importers.by_hand.model_yaml import FILE_NAME
from epg.generator.importers.importer import FoundModel, Importer
from epg.generator.models.model import Model


class ByHand(Importer):
    """``model.yaml``, which also names the FMU whose settings it has."""

    rank = 40

    def find(self, folder: Path) -> list[FoundModel]:
        path = folder / FILE_NAME
        return [FoundModel(path, partial(_load, path))] if path.is_file() else []

    def may_be(self, path: Path) -> bool:
        return path.suffix.lower() in (".yaml", ".yml")

    def at(self, path: Path, diagnostics: Diagnostics) -> FoundModel | None:
        return FoundModel(path, partial(_load, path))


def _load(path: Path, diagnostics: Diagnostics) -> Model | None:
    from epg.generator.importers.by_hand.hand_written import load_hand_written

    return load_hand_written(path, diagnostics)


IMPORTER = ByHand()
