# SPDX-License-Identifier: Apache-2.0
"""The code of a source-code FMU, and its library."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from fractions import Fraction
from pathlib import Path
from typing import Any

from epg.generator.dataclass import dataclass
from epg.generator.emit.text import Code, cstring
from epg.generator.importers.fmu.fmi_headers import fmi_functions, fmi_headers
from epg.generator.models.code import ModelBuild, ModelCode, ModelLibrary, Render
from epg.generator.models.code_parts import GlobalVariable
from epg.generator.models.link import Linked
from epg.generator.models.model import Model


@dataclass(frozen=True)
class FmuPorts:
    """All inputs, or all outputs, of one type of FMI, for example "Real" or "Float64".

    ``references`` are value references; ``positions`` are positions among all inputs or outputs.  An array has one
    reference and several positions.  ``limits`` has for each position the limits of an enumeration, or None.
    """

    type: str
    references: tuple[int, ...]
    positions: tuple[int, ...]
    limits: tuple[tuple[int, int] | None, ...]


@dataclass(frozen=True)
class FmuParameter:
    """A parameter in FMI: its type and its value reference."""

    type: str
    reference: int


@dataclass(frozen=True)
class FmuExport(ModelCode):
    """A source-code FMU of FMI 2.0 or 3.0.

    The names of files and folders are relative to ``root``, the folder or the archive.  For an archive, ``packed``
    holds its files with their texts; for a folder, it is empty.
    """

    standard: int  # 2 or 3
    tool: str  # the program that made the FMU
    guid: str  # in FMI 3.0, the instantiation token
    instance_name: str
    linked: Linked
    root: Path
    units: tuple[str, ...]
    include_dirs: tuple[str, ...]
    packed: tuple[tuple[str, str], ...]
    headers: tuple[str, ...]  # the headers of the standard that the FMU does not contain
    definitions: tuple[tuple[str, str], ...]  # macros with their values
    renames: tuple[str, ...]  # the global symbols; those that are functions of FMI get a prefix instead
    conditional_renames: tuple[tuple[str, tuple[str, ...]], ...]  # those that exist only under a condition of C
    prefixes: tuple[str, ...]  # prefixes that the sources themselves give to the functions of FMI
    plain_names: bool  # True if no header gives a prefix to the functions of FMI
    inputs: tuple[FmuPorts, ...]
    outputs: tuple[FmuPorts, ...]
    parameters: tuple[FmuParameter, ...]
    states: tuple[int, ...]  # value references of continuous states
    state_count: int  # the number of their values: an array has several
    variables: tuple[GlobalVariable, ...]  # reset at a start; empty if the FMU has memory for each instance
    own_step: Fraction | None  # seconds: the step of an FMU of 20-sim, which each call of DoStep requests
    threads: bool  # True if the sources have variables that exist once for each thread
    terminated: bool  # True if the function fmi2GetBooleanStatus exists
    several: bool  # True if a program can have several instances
    heap: int = 0  # bytes of heap for each instance; 0 if the FMU does not allocate memory

    templates = Path(__file__).parent
    judges_itself = True
    on_end = "Ends the simulation of the FMU: steps do nothing until the next init."
    on_stop = "requested a stop"
    alone = "cannot be instantiated more than once"
    other_instance = ": each call makes its own copy of the code"

    @property
    def instantiable(self) -> bool:
        return self.several

    @property
    def finite_while(self) -> str:
        states = ", none of its states is NaN or infinite" if self.states else ""
        return f"the FMU reports no error{states}{' and its heap is large enough' if self.heap else ''}"

    def files(self, library: ModelLibrary, render: Render) -> dict[str, str]:
        name = library.name
        variables = _variables(library.model, self, name, library.values, library.instances)
        return {
            f"{name}_export.c": render("fmu.c.j2", **variables),
            f"{name}_names.h": render("fmu_names.h.j2", **variables),
            **_files(self, name),
        }

    def build(self, library: ModelLibrary, frame: ModelBuild) -> ModelBuild:
        forced = f"{library.name}_names.h"
        frame = replace(frame, forced_header=forced, foreign=Path(library.model.span.file), heap=self.heap)
        if not self.packed:
            return replace(
                frame,
                exported=tuple(self.root / unit for unit in self.units),
                include_dirs=tuple(self.root / place for place in self.include_dirs),
            )
        folder = fmu_folder(library.name)
        return replace(
            frame,
            exported_generated=(*frame.exported_generated, *(f"{folder}/{unit}" for unit in self.units)),
            generated_include_dirs=tuple(f"{folder}/{place}" for place in self.include_dirs),
        )

    def limits_values(self, model: Model) -> bool:
        return _has_limits(self)

    def about(self, model: Model) -> str:
        return f"Made by {self.tool}." if self.tool else "An FMU for co-simulation."

    def with_step(self, model: Model, step: Fraction) -> Model | None:
        """An FMU takes multiples of its own step."""
        return replace(model, step=step) if (step / model.step).denominator == 1 else None


def fmu_folder(name: str) -> str:
    """The name of the folder into which an archive is unpacked."""
    return f"{name}_fmu"


@dataclass(frozen=True)
class FmiType:
    """A type of FMI and its C type ``c``.

    ``low`` and ``high`` are the smallest and the largest double that the C type can hold; of 64 bits, those up to which
    a double has all whole numbers.  They are empty for numbers
    that are doubles in C, too, and for Booleans.  ``whole`` is True for integers.
    """

    name: str  # "Real", "UInt8"
    c: str
    low: str = ""
    high: str = ""
    whole: bool = False


def _integer(name: str, c: str, bits: int, signed: bool) -> FmiType:
    high = float(min((1 << (bits - signed)) - 1, 1 << 53))
    low = max(-float(1 << (bits - 1)), -(2.0**53)) if signed else 0.0
    return FmiType(name, c, repr(low), repr(high), whole=True)


_LARGEST_FLOAT = float.fromhex("0x1.fffffep127")


_TYPES = {
    2: {
        "Real": FmiType("Real", "fmi2Real"),
        "Integer": _integer("Integer", "fmi2Integer", 32, True),
        "Boolean": FmiType("Boolean", "fmi2Boolean"),
    },
    3: {
        "Float64": FmiType("Float64", "fmi3Float64"),
        "Float32": FmiType("Float32", "fmi3Float32", repr(-_LARGEST_FLOAT), repr(_LARGEST_FLOAT)),
        "Boolean": FmiType("Boolean", "fmi3Boolean"),
        **{
            f"{sign}Int{bits}": _integer(f"{sign}Int{bits}", f"fmi3{sign}Int{bits}", bits, not sign)
            for sign in ("", "U")
            for bits in (8, 16, 32, 64)
        },
    },
}


def _variables(
    model: Model, details: FmuExport, name: str, values: Mapping[str, float], instances: int
) -> dict[str, Any]:
    """The template variables of ``fmu.c.j2`` and ``fmu_names.h.j2``."""
    fmi = f"fmi{details.standard}"
    types = _TYPES[details.standard]
    used = sorted({place.type for place in details.parameters})
    titles = [details.instance_name] + [f"{details.instance_name} {index + 1}" for index in range(1, instances)]
    return {
        "fmi": Code(fmi),
        "real": types["Real" if details.standard == 2 else "Float64"],
        "groups_in": [_group(group, types) for group in details.inputs],
        "groups_out": [_group(group, types) for group in details.outputs],
        "parameter_types": [types[kind] for kind in used],
        "places": [
            (used.index(place.type), place.reference, parameter.tunable, parameter)
            for place, parameter in zip(details.parameters, model.parameters, strict=True)
        ],
        "given": [(index, values[p.name], p) for index, p in enumerate(model.parameters) if p.name in values],
        "guid": cstring(details.guid),
        "titles": [cstring(title) for title in titles],
        "functions": fmi_functions(details.standard),
        "heap_functions": ("malloc", "calloc", "realloc", "free", "strdup"),
    }


def _has_limits(details: FmuExport) -> bool:
    """True if a number of the FMU has a range: that of an input or a parameter, or of an output of 64 bits."""
    types = _TYPES[details.standard]
    taken = {group.type for group in details.inputs} | {parameter.type for parameter in details.parameters}
    given = {group.type for group in details.outputs}
    return any(types[name].low for name in taken) or not given.isdisjoint(("Int64", "UInt64"))


def _group(group: FmuPorts, types: Mapping[str, FmiType]) -> dict[str, Any]:
    type = types[group.type]
    limited = [replace(type, low=repr(float(of[0])), high=repr(float(of[1]))) if of else type for of in group.limits]
    places = list(zip(limited, group.positions, strict=True))
    return {"type": type, "references": group.references, "positions": group.positions, "places": places}


def _files(details: FmuExport, name: str) -> dict[str, str]:
    """The files of an FMU that is an archive, and the headers of FMI that the FMU does not contain."""
    files = {f"{fmu_folder(name)}/{path}": text for path, text in details.packed}
    headers = fmi_headers(details.standard)
    return files | {f"{name}_headers/{header}": headers[header] for header in details.headers}
