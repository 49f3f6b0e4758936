# SPDX-License-Identifier: Apache-2.0
"""A ``tokens.xml`` of 20-sim without exported C or C++ files: EPG writes the code from its equations."""

from __future__ import annotations

from functools import partial
from pathlib import Path

from epg.generator.diagnostics import Diagnostics
from epg.generator.importers.importer import FoundModel, Importer
from epg.generator.models.folders import source_files
from epg.generator.models.model import Model
from epg.generator.models.tokens import is_tokens_file, load_tokens


class TokensOnly(Importer):
    """The file with the equations, under any name."""

    rank = 10

    def find(self, folder: Path) -> list[FoundModel]:
        files = [f for f in source_files(folder, (".xml",), 0) if is_tokens_file(f)]
        return [FoundModel(file, partial(_load, file)) for file in files]

    def may_be(self, path: Path) -> bool:
        return path.suffix.lower() == ".xml"

    def at(self, path: Path, diagnostics: Diagnostics) -> FoundModel | None:
        return FoundModel(path, partial(_load, path))


def _load(path: Path, diagnostics: Diagnostics) -> Model | None:
    from epg.generator.importers.tokens.tokens_model import load_tokens_model

    tokens = load_tokens(path, diagnostics, required=True)
    return load_tokens_model(tokens, diagnostics) if tokens else None


IMPORTER = TokensOnly()
