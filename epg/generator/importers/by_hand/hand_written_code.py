# SPDX-License-Identifier: Apache-2.0
"""The code of a controller written by hand, and its library."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from epg.generator.dataclass import dataclass
from epg.generator.importers.copies import include_name
from epg.generator.models.code import ModelBuild, ModelCode, ModelLibrary, Render
from epg.generator.models.model import Model


@dataclass(frozen=True)
class BitField:
    """The range of a bit-field: its compiler tells the type, but not the width."""

    low: int
    high: int


@dataclass(frozen=True)
class HandWritten(ModelCode):
    """A controller written by hand: a ``model.yaml`` and the user's own sources."""

    style: str  # "struct" or "arrays"
    header: str
    sources: tuple[Path, ...]
    include_dirs: tuple[Path, ...]
    instance: str  # the C type of an instance; empty if the functions do not take an instance
    inputs_type: str
    outputs_type: str
    init: str
    step: str
    terminate: str
    stopped: str
    finite: str
    members: tuple[str, ...]  # for each parameter, the member of the instance or the global variable
    input_fields: tuple[BitField | None, ...]  # for each input, its bit-field; None if its member is not one
    output_fields: tuple[BitField | None, ...]
    parameter_fields: tuple[BitField | None, ...]
    renames: tuple[str, ...]
    system_headers: tuple[str, ...]

    templates = Path(__file__).parent
    finite_while = "no output is NaN or infinite"

    @property
    def instantiable(self) -> bool:
        return bool(self.instance)

    @property
    def starts_by_step(self) -> bool:
        return not self.init

    def files(self, library: ModelLibrary, render: Render) -> dict[str, str]:
        model, name = library.model, library.name
        is_c = model.language == "c"
        values = [library.values.get(parameter.name, parameter.value) for parameter in model.parameters]
        sources = [include_name(path, self.include_dirs) for path in self.sources]
        text = render("hand_written.j2", values=values, sources=sources)
        if not is_c:
            return {f"{name}_export.cpp": text}
        return {f"{name}_export.c": text, f"{name}_names.h": render("names.h.j2", renames=self.renames)}

    def build(self, library: ModelLibrary, frame: ModelBuild) -> ModelBuild:
        places = sorted({source.parent for source in self.sources})
        frame = replace(frame, include_dirs=tuple(dict.fromkeys((*self.include_dirs, *places))))
        if library.model.language != "c":
            return frame
        return replace(frame, exported=self.sources, forced_header=f"{library.name}_names.h")

    def limits_values(self, model: Model) -> bool:
        return self.style == "struct" or bool(model.parameters)

    def about(self, model: Model) -> str:
        return "A model written by hand."
