# SPDX-License-Identifier: Apache-2.0
"""The variables of a model, found in its object files, which a build gives to this module.

The object files are copied with a symbol at the start of each section with variables.  A generated C file has the table
of these sections; ``targets/runtime/include/epg/variables.h`` describes it.

Two kinds of variables are left out: objects of C++ that are constructed again, and the heap of an FMU.  Their names in
the templates contain ``epg_object_``.  ``epg_instance_`` marks the other memory of instances.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import Path

from epg.generator.dataclass import dataclass
from epg.generator.diagnostics import Diagnostics
from epg.generator.documents.coff_file import MACHINES, CoffObject
from epg.generator.documents.elf_file import ElfObject
from epg.generator.documents.object_file import NotAnObjectFile, ObjectFile, ObjectVariable, Section
from epg.generator.emit.template import environment
from epg.generator.emit.text import Code
from epg.generator.source import Span

TEMPLATES = Path(__file__).resolve().parent / "templates"

_EXCLUDED = "epg_object_"
_OF_INSTANCES = (_EXCLUDED, "epg_instance_")
_OF_COMPILER = ("__", "_ZSt", "_ZGV")  # sanitizers, the standard library of C++, guards of function-local objects


_NO_DESTRUCTORS = dict.fromkeys(("__cxa_atexit", "__aeabi_atexit", "atexit"), "epg_variables_no_destructor")
"""Each start constructs function-local objects again, and would register their destructors once more."""


@dataclass(frozen=True)
class Region:
    """A part of section ``symbol`` that is restored."""

    symbol: str
    offset: int
    size: int
    zero: bool


def model_variables(
    name: str, instances: int, objects: Sequence[Path], diagnostics: Diagnostics
) -> tuple[list[bytes], str]:
    """Copies of the object files of model ``name``, and the text of its C file with the table of variables."""
    files = {path: file for path in objects if (file := _read(path, diagnostics)) is not None}
    for path, file in files.items():
        _check(path, file, f"{name}_private_", instances, diagnostics)
    diagnostics.stop_if_errors()
    constructed = any(file.has_constructors() for file in files.values())
    regions: list[Region] = []
    copies = []
    for index, file in enumerate(files.values()):
        sections = file.sections() if instances == 1 else []
        symbols = {section.number: f"{name}_export_section_{index}_{section.number}" for section in sections}
        copies.append(file.with_symbols(symbols, _NO_DESTRUCTORS))
        for section in sections:
            regions += _regions(file, section, symbols[section.number], constructed)
    return copies, _table(name, regions)


def _read(path: Path, diagnostics: Diagnostics) -> ObjectFile | None:
    data = path.read_bytes()
    try:
        return CoffObject(data) if data[:2] in MACHINES else ElfObject(data)
    except NotAnObjectFile as problem:
        _refuse(path, f"EPG cannot find its variables, because {problem}", _FORMAT_HINT, diagnostics)
        return None


def _check(path: Path, file: ObjectFile, prefix: str, instances: int, diagnostics: Diagnostics) -> None:
    """Reports variables of ``file`` that cannot be restored.  Messages leave out the ``prefix`` of renamed symbols."""
    for variable in file.common():
        problem = f"the linker can join variable '{_written(variable, prefix)}' with one of other code"
        _refuse(path, problem, "take -fcommon out of the options of the compiler", diagnostics)
    for section in file.sections():
        for variable in file.variables(section.number):
            if reason := _reason(section, variable, instances):
                problem, hint = reason
                _refuse(path, f"variable '{_written(variable, prefix)}' {problem}", hint, diagnostics)


def _reason(section: Section, variable: ObjectVariable, instances: int) -> tuple[str, str] | None:
    """Why a variable cannot be restored, and a hint; or None."""
    if variable.separate:
        return "exists once for each thread", "make it an ordinary static variable"
    if section.shared:
        return "can be the same as one of other code", "make it static, or const"
    if instances == 1 or _has(variable, _OF_INSTANCES) or variable.name.startswith(_OF_COMPILER):
        return None
    problem = "belongs to all instances, so the start of one of them would change the others"
    return problem, "make it a member of the instance, or const; or make one instance"


_FORMAT_HINT = "compile the model with GCC or Clang, and without link-time optimisation (-flto)"


def _refuse(path: Path, reason: str, hint: str, diagnostics: Diagnostics) -> None:
    message = f"a second start of the model cannot be like its first: {reason}"
    diagnostics.error("model-not-restartable", Span(str(path)), message, hint=hint)


def _written(variable: ObjectVariable, prefix: str) -> str:
    """The name of a variable as its source has it; of a name of C++, the part after the last ``::``."""
    name = variable.name
    if name.startswith("_Z"):
        at = 2
        while (match := re.compile(r"\D*?(\d+)(?=[A-Za-z_])").match(variable.name, at)) is not None:
            at = match.end() + int(match[1])
            name = variable.name[match.end() : at]
    return re.sub(r"\.\d+$", "", name.removeprefix(prefix))


def _has(variable: ObjectVariable, marks: Sequence[str]) -> bool:
    return any(mark in variable.name for mark in marks)


def _regions(file: ObjectFile, section: Section, symbol: str, constructed: bool) -> list[Region]:
    """The parts of ``section`` between the variables that are left out."""
    regions = []
    zero = section.zero and not constructed
    start = 0
    excluded = [variable for variable in file.variables(section.number) if _has(variable, (_EXCLUDED,))]
    for offset, end in [*((v.offset, v.offset + v.size) for v in excluded), (section.size, section.size)]:
        if offset > start:
            regions.append(Region(symbol, start, offset - start, zero))
        start = max(start, end)
    return regions


def _table(name: str, regions: Sequence[Region]) -> str:
    kept = sum((region.size + 3) // 4 for region in regions if not region.zero)
    values = {
        "name": Code(name),
        "regions": [(Code(region.symbol), region) for region in regions],
        "symbols": [Code(symbol) for symbol in dict.fromkeys(region.symbol for region in regions)],
        "kept": kept,
        "restored": sum(region.size for region in regions),
    }
    return environment([TEMPLATES]).get_template("variables.c.j2").render(values)
