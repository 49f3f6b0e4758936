# SPDX-License-Identifier: Apache-2.0
"""The variables of the template ``c_function.c.j2``."""

from __future__ import annotations

from typing import Any

from epg.generator.emit.text import Code
from epg.generator.importers.c_function.c_function_export import CFunctionExport
from epg.generator.models.code import ModelLibrary
from epg.generator.models.model import Model


def c_function_variables(details: CFunctionExport, library: ModelLibrary) -> dict[str, Any]:
    """The template variables for ``details``."""
    model, terminate = library.model, library.terminate
    doubles = details.real == "double"
    return {
        "entries": [entry for entry in _entries(details) if terminate or entry is not details.terminate],
        "to_double": Code("" if doubles else "(double)"),
        "copied": not doubles or bool(details.outputs) or not model.outputs,
    } | (_instance_memory(details) if details.instance_type else _global_memory(model, details))


def _instance_memory(details: CFunctionExport) -> dict[str, Any]:
    """The variables about an export whose arrays are members of an instance.

    In the export, xx_P is a macro for model_instance->P.  In sources of an FMU, the members are pointers into one
    common memory, which has all arrays.  In an export by EPG's target for 20-sim, they are arrays, and only those that
    the model needs exist.
    """
    members = [name for name, _ in details.memory] or ["s", "R"]
    states = [member for member in ("s", "R") if member in members] if _states(details) else []
    return {
        "pointers": (),
        "unsized": (),
        "own_time": False,
        "time": Code("epg_instance_models[index].time"),
        "states": [Code(f"epg_instance_models[index].{member}") for member in states],
        "parameter_array": Code("epg_instance_models[index].P"),
    }


def _global_memory(model: Model, details: CFunctionExport) -> dict[str, Any]:
    """The variables about an export whose arrays are global variables."""
    declared = {variable.name for variable in details.variables}
    elements = [element.array for element in (*details.inputs, *details.outputs)]
    states = _states(details)
    wanted = {*states, *elements, *([details.parameters] if model.parameters else [])}
    return {
        "pointers": sorted(wanted & set(details.pointers)),
        "unsized": sorted(wanted - set(details.pointers) - declared),
        "own_time": details.time not in declared,
        "time": Code(details.time if details.time in declared else "epg_time"),
        "states": [Code(array) for array in states],
        "parameter_array": Code(details.parameters),
    }


def _states(details: CFunctionExport) -> list[str]:
    return [array for array in (details.states, details.rates) if array] if details.state_count else []


def _entries(details: CFunctionExport) -> list[Any]:
    entries = [
        details.model_initialize,
        details.initialize,
        details.calculate,
        details.terminate,
        details.calculate_static,
    ]
    return [entry for entry in entries if entry is not None and entry.name]
