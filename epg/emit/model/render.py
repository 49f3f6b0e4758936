# SPDX-License-Identifier: Apache-2.0
"""Renders the templates of a model's library."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Mapping, Sequence
from functools import cache
from pathlib import Path
from typing import Any

import jinja2

from epg.emit.model.copies import copies, copy_name
from epg.emit.template import environment
from epg.emit.text import Code, comment
from epg.models.details import CFunctionExport, CppClassExport, FmuExport, HandWritten, TokensExport
from epg.models.link import Linked
from epg.models.model import Model, Parameter, Port


def render(model: Model, name: str, values: Mapping[str, float], instances: int, terminate: bool) -> dict[str, str]:
    """The text of all files of the library that are made from templates, by file name."""
    common: dict[str, Any] = {
        "model": model,
        "name": Code(name),
        "instances": instances,
        "parameters": list(zip(parameter_constants(name, model.parameters), model.parameters)),
        "tunable": sum(parameter.tunable for parameter in model.parameters),
        "derives": _derives(model),
        "terminate": terminate,
        # These exports write all their outputs in each call.  Others can leave outputs as they are.
        "direct": isinstance(model.details, CFunctionExport | TokensExport),
        "in_order": all(parameter.index == index for index, parameter in enumerate(model.parameters)),
        "e": model.details,
        "hand_written": isinstance(model.details, HandWritten),
        "fmu": isinstance(model.details, FmuExport),
        "about": _about(model),
    }
    env = _environment()
    files = {
        f"{name}.h": env.get_template("header.h.j2").render(common),
        f"{name}.c": env.get_template("wrapper.c.j2").render(common),
        f"{name}_export.h": env.get_template("export.h.j2").render(common),
    }
    details = model.details
    if isinstance(details, CFunctionExport):
        files[f"{name}_export.c"] = env.get_template("c_function.c.j2").render(
            common | _c_function(model, details, terminate)
        )
        files[f"{name}_names.h"] = env.get_template("names.h.j2").render(common, renames=details.renames)
    elif isinstance(details, CppClassExport):
        context = common | _cpp_class(model, details, name, values)
        files[f"{name}_export.cpp"] = env.get_template("cpp_class.cpp.j2").render(context)
    elif isinstance(details, TokensExport):
        from epg.emit.model.tokens_code import helper_texts, tokens_code

        context = common | tokens_code(model, details, values) | {"helpers": helper_texts(details.functions)}
        files[f"{name}_export.c"] = env.get_template("tokens.c.j2").render(context)
    elif isinstance(details, FmuExport):
        from epg.emit.model.fmu_code import fmu_code, fmu_files

        context = common | fmu_code(model, details, name, values, instances)
        files[f"{name}_export.c"] = env.get_template("fmu.c.j2").render(context)
        files[f"{name}_names.h"] = env.get_template("fmu_names.h.j2").render(context)
        files |= fmu_files(details, name)
    elif isinstance(details, HandWritten):
        context = common | {
            "values": [values.get(parameter.name, parameter.value) for parameter in model.parameters],
            "sources": [_include_name(path, details.include_dirs) for path in details.sources],
        }
        suffix = "cpp" if model.language == "c++" else "c"
        files[f"{name}_export.{suffix}"] = env.get_template("hand_written.j2").render(context)
        if model.language == "c":
            files[f"{name}_names.h"] = env.get_template("names.h.j2").render(common, renames=details.renames)
    else:
        raise TypeError(f"no template for {type(details).__name__}")
    return files


def _derives(model: Model) -> bool:
    """True if values that are derived from parameters are computed only at the start and after a change."""
    details = model.details
    return isinstance(details, TokensExport) or (
        isinstance(details, CFunctionExport) and bool(details.calculate_static)
    )


_PUBLIC = """t inputs inputs_t outputs outputs_t parameter parameter_t instance init step terminate stopped finite
get_parameter set_parameter set_parameters heap_used""".split()
"""The parts after ``<name>_`` in the names of the types and functions of a library."""


def parameter_constants(name: str, parameters: Sequence[Parameter]) -> list[str]:
    """The names of the parameters in the C enumeration: ``PAN_PID1_KP``.

    Parameters whose names differ only in case keep their case: ``PAN_Kp``, ``PAN_KP``.
    """
    upper = [f"{name}_{parameter.identifier}".upper() for parameter in parameters]
    reserved = {
        f"{name}_{word}".upper()
        for word in ("h", "step_size", "instances", "parameters", "heap_size", "export_h", "names_h")
    }
    # A library named in capitals: PAN_step() is a function, and the parameters can be called "step" and "STEP".
    reserved |= {f"{name}_{word}" for word in _PUBLIC}
    result: dict[str, None] = {}  # a set that keeps its order
    counts = Counter(upper)
    for constant, parameter in zip(upper, parameters, strict=True):
        unique = constant if counts[constant] == 1 else f"{name.upper()}_{parameter.identifier}"
        while unique in reserved or unique in result:
            unique += "_"
        result[unique] = None
    return list(result)


@cache
def _environment() -> jinja2.Environment:
    env = environment([Path(__file__).resolve().parent / "templates"])
    env.filters["parsed"] = Code  # text that EPG's parsers took from a C source: it is C already
    env.filters["told"] = _told
    env.filters["last_name"] = lambda text: str(text).rpartition("::")[2].removeprefix("struct ")
    return env


def _about(model: Model) -> str:
    if isinstance(model.details, FmuExport):
        return f"Made by {model.details.tool}." if model.details.tool else "An FMU for co-simulation."
    if not model.method:
        return "A model written by hand."
    methods = {"RungeKutta2": "Runge Kutta 2", "RungeKutta4": "Runge Kutta 4"}
    return f"Integration method: {methods.get(model.method, model.method)}."


def _told(item: Port | Parameter) -> Code:
    """The text about a port or parameter in a C comment: ``in {rad}``."""
    unit = f" {{{item.unit}}}" if item.unit else ""
    kind = f", {item.type}" if isinstance(item, Port) and item.type != "real" else ""
    told = f": {item.description}" if isinstance(item, Port) and item.description else ""
    value = f" = {item.value!r}" if isinstance(item, Parameter) else ""
    return comment(f"{item.name}{unit}{kind}{value}{told}")


def _c_function(model: Model, details: CFunctionExport, terminate: bool) -> dict[str, Any]:
    """The template variables of ``c_function.c.j2``."""
    doubles = details.real == "double"
    context = {
        "entries": [entry for entry in _entries(details) if terminate or entry is not details.terminate],
        "to_real": Code("" if doubles else f"({details.real})"),
        "to_double": Code("" if doubles else "(double)"),
        "copied": not doubles or bool(details.outputs) or not model.outputs,
    }
    declared = {variable.name for variable in details.variables}
    states = [array for array in (details.states, details.rates) if array] if details.state_count else []
    elements = [element.array for element in (*details.inputs, *details.outputs)]
    wanted = {*states, *elements, *([details.parameters] if model.parameters else [])}
    if details.instance_type:
        # The arrays are members of the instance: in the export, xx_P is a macro for model_instance->P.  In sources of
        # an FMU, the members are pointers into one common memory, which has all arrays.  In an export by EPG's target
        # for 20-sim, they are arrays, and only those that the model needs exist.
        members = [name for name, _ in details.memory] or ["s", "R"]
        return context | {
            "pointers": (),
            "unsized": (),
            "own_time": False,
            "time": Code("epg_models[index].time"),
            "states": [Code(f"epg_models[index].{member}") for member in ("s", "R") if states and member in members],
            "parameter_array": Code("epg_models[index].P"),
        }
    return context | {
        "pointers": sorted(wanted & set(details.pointers)),
        "unsized": sorted(wanted - set(details.pointers) - declared),
        "own_time": details.time not in declared,
        "time": Code(details.time if details.time in declared else "epg_time"),
        "states": [Code(array) for array in states],
        "parameter_array": Code(details.parameters),
    }


def _entries(details: CFunctionExport) -> list[Any]:
    entries = [
        details.model_initialize,
        details.initialize,
        details.calculate,
        details.terminate,
        details.calculate_static,
    ]
    return [entry for entry in entries if entry is not None and entry.name]


def _cpp_class(model: Model, details: CppClassExport, name: str, values: Mapping[str, float]) -> dict[str, Any]:
    edited = copies(model, name, values)
    sources = []
    for code in details.linked.units:
        copy = copy_name(name, code.file.path)
        sources.append(copy if copy in edited else _include_name(code.file.path, details.linked.include_dirs))
    return {"sources": sources, "system_headers": _system_headers(details.linked), "prefix": details.parameters[:-1]}


def _include_name(path: Path, folders: Sequence[Path]) -> str:
    """The shortest name by which the include path finds ``path`` and not another file."""
    names = [path.relative_to(folder).as_posix() for folder in folders if path.is_relative_to(folder)]
    names = sorted(names, key=len) or [path.name]
    for name in names:
        first = next((folder / name for folder in folders if (folder / name).is_file()), path)
        if first == path:
            return name
    return names[-1]


def _system_headers(linked: Linked) -> list[str]:
    names = {include.name for code in linked.all for include in code.includes if include.system}
    return sorted(name for name in names if re.fullmatch(r"[\w./+-]+", name))
