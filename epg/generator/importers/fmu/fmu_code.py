# SPDX-License-Identifier: Apache-2.0
"""The variables of the templates of an FMU's library: names of FMI functions, variables grouped by type, files."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from epg.generator.dataclass import dataclass
from epg.generator.emit.text import Code, cstring
from epg.generator.importers.fmu.fmi_headers import fmi_functions, fmi_headers
from epg.generator.importers.fmu.fmu_export import FmuExport, FmuPorts, fmu_folder
from epg.generator.models.model import Model


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


def fmu_code(
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


def has_limits(details: FmuExport) -> bool:
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


def fmu_files(details: FmuExport, name: str) -> dict[str, str]:
    """The files of an FMU that is an archive, and the headers of FMI that the FMU does not contain."""
    files = {f"{fmu_folder(name)}/{path}": text for path, text in details.packed}
    headers = fmi_headers(details.standard)
    return files | {f"{name}_headers/{header}": headers[header] for header in details.headers}
