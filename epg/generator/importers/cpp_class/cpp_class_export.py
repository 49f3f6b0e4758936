# SPDX-License-Identifier: Apache-2.0
"""The code of an export of 20-sim's C++ class target, and its library."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path

from epg.generator.dataclass import dataclass
from epg.generator.importers.copies import copies, copy_name, include_name, shims
from epg.generator.models.code import ModelBuild, ModelCode, ModelLibrary, Render
from epg.generator.models.code_parts import SourceRange
from epg.generator.models.link import Linked
from epg.generator.models.model import Model


@dataclass(frozen=True)
class CppClassExport(ModelCode):
    """An export of 20-sim's C++ class target."""

    linked: Linked
    class_name: str
    real: str
    methods: frozenset[str]  # of the class: not every version of 20-sim has "Reset" and "SetFinishTime"
    members: frozenset[str]  # data members of the class and its bases: "m_stop_run", ...
    state_count: int
    parameters: str  # names of arrays
    states: str
    rates: str
    places: tuple[tuple[SourceRange, ...], ...]
    templates = Path(__file__).parent

    def files(self, library: ModelLibrary, render: Render) -> dict[str, str]:
        name = library.name
        edited = copies(self.linked, self.places, library)
        sources = []
        for code in self.linked.units:
            copy = copy_name(name, code.file.path)
            sources.append(copy if copy in edited else include_name(code.file.path, self.linked.include_dirs))
        text = render(
            "cpp_class.cpp.j2",
            sources=sources,
            system_headers=_system_headers(self.linked),
            prefix=self.parameters[:-1],
        )
        return {f"{name}_export.cpp": text} | edited | shims(self.linked, name)

    def build(self, library: ModelLibrary, frame: ModelBuild) -> ModelBuild:
        return replace(frame, include_dirs=self.linked.include_dirs)

    def limits_values(self, model: Model) -> bool:
        return self.real != "double"


def _system_headers(linked: Linked) -> list[str]:
    names = {include.name for code in linked.all for include in code.includes if include.system}
    return sorted(name for name in names if re.fullmatch(r"[\w./+-]+", name))
