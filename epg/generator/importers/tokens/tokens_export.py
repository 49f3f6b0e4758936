# SPDX-License-Identifier: Apache-2.0
"""The code of a ``tokens.xml`` without exported C or C++ files, and its library."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from pathlib import Path

from epg.generator.dataclass import dataclass
from epg.generator.models.code import ModelBuild, ModelCode, ModelLibrary, Render
from epg.generator.models.features import rounded_in
from epg.generator.models.model import Model
from epg.generator.models.tokens import Tokens


@dataclass(frozen=True)
class TokensExport(ModelCode):
    """A ``tokens.xml`` without exported C or C++ files."""

    tokens: Tokens
    functions: tuple[str, ...]  # the helper functions that the equations call, without prefix: "Absolute", "Sign", ...
    templates = Path(__file__).parent
    writes_every_output = True
    derives = True

    def files(self, library: ModelLibrary, render: Render) -> dict[str, str]:
        from epg.generator.importers.tokens.tokens_code import helper_texts, tokens_code

        variables = tokens_code(library.model, self, library.values) | {"helpers": helper_texts(self.functions)}
        return {f"{library.name}_export.c": render("tokens.c.j2", **variables)}

    def build(self, library: ModelLibrary, frame: ModelBuild) -> ModelBuild:
        return frame

    def rounded(self, model: Model) -> frozenset[str]:
        from epg.generator.importers.tokens.tokens_code import helper_texts

        return model.rounded | rounded_in(" ".join(helper_texts(self.functions)))

    def with_step(self, model: Model, step: Fraction) -> Model | None:
        """An integration method takes any step."""
        return None if model.method == "Discrete" else replace(model, step=step)
