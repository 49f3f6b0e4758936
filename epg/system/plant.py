# SPDX-License-Identifier: Apache-2.0
"""The plant of a whole system: one model, whose bindings name components as ``target/component``.

All checks compare the plant with all targets.  In the simulation, each target gets the wires to its own components.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import replace

from epg.generator.check.bindings import Binding, Bindings, load_bindings
from epg.generator.check.model import check_model_names
from epg.generator.diagnostics import Diagnostics, Note, did_you_mean
from epg.generator.models.model import Model
from epg.generator.project import ModelReader
from epg.generator.quantity import show
from epg.generator.resolve.application import Application, Plant, ResolvedComponent
from epg.generator.resolve.resolve import PlantFiles, wired_plant
from epg.system.system import System, SystemPlant


def load_plant(plant: SystemPlant, read_model: ModelReader, diagnostics: Diagnostics) -> PlantFiles | None:
    """The model with the step of the system's file, and the bindings; None after reporting mistakes in the files."""
    model = read_model(plant.model, diagnostics)
    bindings = load_bindings(plant.bindings, diagnostics, plant.span)
    if model is None or bindings is None:
        return None
    if plant.period is not None:
        stepped = model.with_step(plant.period)
        if stepped is None:
            message = f"the step of {model.name} is {show(model.step, 'time')}: its code does not take another one"
            hint = "remove 'period', or export the model with this step"
            notes = [Note("the model", model.span)]
            diagnostics.error("plant-period", plant.period_span, message, hint=hint, notes=notes)
            return None
        model = stepped
    step = model.step * 10**9
    if max(step.numerator, step.denominator) >= 2**63:
        message = f"the step of {model.name} has too many digits: {step} ns"
        diagnostics.error("plant-period", plant.period_span, message, hint="state a 'period', such as '1 ms'")
        return None
    return PlantFiles(model, bindings)


def check_plant(
    files: PlantFiles, system: System, applications: Mapping[str, Application], diagnostics: Diagnostics
) -> Plant | None:
    """The plant with the wires to all targets, or None after reporting why they do not fit together."""
    errors = diagnostics.error_count
    for binding in _bindings_of(files.bindings):
        _check_target(binding, system, diagnostics)
    if "plant" in system.targets:
        message = "a system with a plant cannot have a target 'plant': both have the file plant.csv"
        span = system.targets["plant"].span
        diagnostics.error("invalid-name", span, message, hint="choose another name for the target")
    check_model_names(files.model, f"{system.name}_plant", diagnostics)
    if diagnostics.error_count > errors:
        return None
    components = {
        f"{target}/{component.name}": replace(component, name=f"{target}/{component.name}")
        for target, application in applications.items()
        for component in application.components
    }
    wired = wired_plant(files, components, diagnostics)
    return wired if diagnostics.error_count == errors else None


def _check_target(binding: Binding, system: System, diagnostics: Diagnostics) -> None:
    """Reports a component without the name of a target, and targets that cannot be bound."""
    name, separator, component = binding.component.partition("/")
    if not separator:
        message = f"'{name}' does not name a target"
        hint = f"write the name of its target in front: '{next(iter(system.targets))}/{name}'"
        diagnostics.error("unknown-target", binding.span, message, hint=hint)
        return
    target = system.targets.get(name)
    if target is None:
        message = f"this system has no target '{name}'"
        numbered = [other for other in system.targets if re.fullmatch(rf"{re.escape(name)}_\d+", other)]
        hint = f"name one of them: {', '.join(numbered)}" if numbered else did_you_mean(name, system.targets, "targets")
        diagnostics.error("unknown-target", binding.span, message, hint=hint)
    elif target.plant is not None:
        message = f"'{name}' has a plant already, which moves '{component}'"
        notes = [Note("the target", target.span)]
        hint = f"remove 'plant' and 'plant_bindings' of '{name}', or its components from these bindings"
        diagnostics.error("two-plants", binding.span, message, hint=hint, notes=notes)


def targets_of(files: PlantFiles) -> frozenset[str]:
    """The targets that the plant moves or is moved by."""
    return frozenset(binding.component.partition("/")[0] for binding in _bindings_of(files.bindings))


def with_plant(
    application: Application, target: str, files: PlantFiles, library: str, diagnostics: Diagnostics
) -> Application:
    """The application of ``target`` with the wires of its own components to the plant in ``library``."""
    read = {*application.files, files.bindings.path}
    if target not in targets_of(files):
        return replace(application, files=tuple(sorted(read)))
    own = _of_target(files, target)
    components: dict[str, ResolvedComponent] = {component.name: component for component in application.components}
    plant = replace(wired_plant(own, components, diagnostics), library=library)
    return replace(application, plant=plant, files=tuple(sorted({*read, *files.model.files})))


def _of_target(files: PlantFiles, target: str) -> PlantFiles:
    """The part of the plant that belongs to one target: its bindings, and the ports that they name."""
    bindings, model = files.bindings, files.model
    inputs = {
        name: (span, _own(binding)) for name, (span, binding) in bindings.inputs.items() if _is_of(binding, target)
    }
    outputs = {
        name: (span, tuple(_own(binding) for binding in bound if _is_of(binding, target)))
        for name, (span, bound) in bindings.outputs.items()
        if any(_is_of(binding, target) for binding in bound)
    }
    return PlantFiles(
        _with_ports(model, inputs, outputs), replace(bindings, inputs=inputs, outputs=outputs, parameters={})
    )


def _with_ports(model: Model, inputs: Mapping[str, object], outputs: Mapping[str, object]) -> Model:
    return replace(
        model,
        inputs=tuple(port for port in model.inputs if port.name in inputs),
        outputs=tuple(port for port in model.outputs if port.name in outputs),
    )


def _is_of(binding: Binding, target: str) -> bool:
    return binding.component.partition("/")[0] == target


def _own(binding: Binding) -> Binding:
    return replace(binding, component=binding.component.partition("/")[2])


def _bindings_of(bindings: Bindings) -> list[Binding]:
    found = [binding for _, binding in bindings.inputs.values()]
    return found + [binding for _, bound in bindings.outputs.values() for binding in bound]
