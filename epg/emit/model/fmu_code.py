# SPDX-License-Identifier: Apache-2.0
"""The variables of the templates of an FMU's library: names of FMI functions, variables grouped by type, files."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from epg.dataclass import dataclass
from epg.emit.model.fmi_headers import fmi_functions, fmi_headers
from epg.emit.text import Code, cstring
from epg.models.details import FmuExport, FmuPorts
from epg.models.model import Model


@dataclass(frozen=True)
class FmiType:
    """A type of FMI and its C type ``c``.

    ``low`` and ``high`` are the smallest and the largest double that the C type can hold.  They are empty for real
    numbers and Booleans.
    """

    name: str  # "Real", "UInt8"
    c: str
    low: str = ""
    high: str = ""


def _integer(name: str, c: str, bits: int, signed: bool) -> FmiType:
    high = float((1 << (bits - signed)) - 1) if bits < 64 else float((1 << (64 - signed)) - (1 << (11 - signed)))
    low = -float(1 << (bits - 1)) if signed else 0.0
    return FmiType(name, c, repr(low), repr(high))


_TYPES = {
    2: {
        "Real": FmiType("Real", "fmi2Real"),
        "Integer": _integer("Integer", "fmi2Integer", 32, True),
        "Boolean": FmiType("Boolean", "fmi2Boolean"),
    },
    3: {
        "Float64": FmiType("Float64", "fmi3Float64"),
        "Float32": FmiType("Float32", "fmi3Float32"),
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


def fmu_folder(name: str) -> str:
    """The name of the folder into which an archive is unpacked."""
    return f"{name}_fmu"
