# SPDX-License-Identifier: Apache-2.0
"""The code of an export of 20-sim's C function target, and its library."""

from __future__ import annotations

import re
from dataclasses import replace
from fractions import Fraction
from pathlib import Path
from typing import Any

from epg.generator.dataclass import dataclass
from epg.generator.emit.text import Code
from epg.generator.importers.copies import ParameterPlaces, copies, copy_name, new_values, shims
from epg.generator.models.assignments import exact_number
from epg.generator.models.code import ModelBuild, ModelCode, ModelLibrary, Render
from epg.generator.models.code_parts import GlobalVariable
from epg.generator.models.link import Linked
from epg.generator.models.model import Model


@dataclass(frozen=True)
class EntryPoint:
    """A function of the export that the wrapper calls.  ``arguments`` are the meanings of its arguments, in order.

    "u" and "y" are the vectors of ports.  "time" is the time before the step and "next_time" the time after it.
    "step" is the step size, which some users pass instead of the time.  "instance" is a pointer to the model's memory.
    """

    name: str
    arguments: tuple[str, ...]
    result: str = "void"  # the type of its result, in C


@dataclass(frozen=True)
class PortElement:
    """The array element that holds a port, in exports without ``u[]`` and ``y[]``: sources of FMUs."""

    array: str
    index: int


@dataclass(frozen=True)
class CFunctionExport(ModelCode):
    """An export of 20-sim's C function target, or the C sources of its FMU target."""

    linked: Linked
    real: str  # the C type of XXDouble
    initialize: EntryPoint
    calculate: EntryPoint
    terminate: EntryPoint
    calculate_static: EntryPoint | None
    model_initialize: EntryPoint | None  # None if Initialize calls it; it does not in FMUs of 20-sim 4.6 and later
    inputs: tuple[PortElement, ...]  # empty if the entry points take vectors of ports
    outputs: tuple[PortElement, ...]
    parameters: str  # names of arrays
    states: str
    rates: str
    state_count: int
    pointers: tuple[str, ...]  # the global variables that are pointers, for example into the export's memory
    time: str  # names of variables; empty if the model does not have them
    stop: str
    variables: tuple[GlobalVariable, ...]
    places: ParameterPlaces
    instance_type: str  # the typedef of the model's memory; empty for exports with global variables
    instance_header: str  # the header that declares this type
    memory: tuple[tuple[str, str], ...]  # the pointers in an instance, each with its offset in MEMORY
    declared: bool  # True if that header also declares the entry points
    renames: tuple[str, ...]  # the global symbols, which generated macros rename

    templates = Path(__file__).parent
    writes_every_output = True

    @property
    def instantiable(self) -> bool:
        return bool(self.instance_type)

    @property
    def derives(self) -> bool:
        return bool(self.calculate_static)

    def files(self, library: ModelLibrary, render: Render) -> dict[str, str]:
        name = library.name
        texts = {
            f"{name}_export.c": render("c_function.c.j2", **_variables(self, library)),
            f"{name}_names.h": render("names.h.j2", renames=self.renames),
        }
        return texts | copies(self.linked, self.places, library) | shims(self.linked, name)

    def build(self, library: ModelLibrary, frame: ModelBuild) -> ModelBuild:
        edited = new_values(self.places, library)
        return replace(
            frame,
            exported_generated=(*frame.exported_generated, *sorted(copy_name(library.name, path) for path in edited)),
            exported=tuple(code.file.path for code in self.linked.units if code.file.path not in edited),
            include_dirs=self.linked.include_dirs,
            forced_header=f"{library.name}_names.h",
        )

    def limits_values(self, model: Model) -> bool:
        return self.real != "double"

    def with_step(self, model: Model, step: Fraction) -> Model | None:
        """The step of an export without instances is a variable with an initial value: ``xx_step_size = 0.001;``."""
        named = [variable for variable in self.variables if "step_size" in variable.name]
        if self.instance_type or model.method == "Discrete":
            return None
        if len(named) != 1 or exact_number(named[0].value) != model.step:
            return None
        assigned = re.compile(rf"(?<!\w){re.escape(named[0].name)}\s{{0,80}}=(?!=)", re.ASCII)
        if sum(len(assigned.findall(code.file.code)) for code in self.linked.units) != 1:
            return None
        value = repr(float(step))
        variables = tuple(replace(v, value=value, changed=True) if v is named[0] else v for v in self.variables)
        return replace(model, step=step, code=replace(self, variables=variables))


def _variables(details: CFunctionExport, library: ModelLibrary) -> dict[str, Any]:
    """The variables of the template ``c_function.c.j2``."""
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
