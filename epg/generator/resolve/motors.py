# SPDX-License-Identifier: Apache-2.0
"""Compares the section ``motors`` of a plant's bindings with the plant."""

from __future__ import annotations

from epg.generator.check.bindings import Bindings
from epg.generator.diagnostics import Diagnostics, did_you_mean
from epg.generator.models.model import Model


def check_motors(bindings: Bindings, plant: Model, diagnostics: Diagnostics) -> None:
    """Reports names that are not ports or parameters of the plant."""
    inputs, outputs = [port.name for port in plant.inputs], [port.name for port in plant.outputs]
    known = parameter_names(plant)
    for motor in bindings.motors.values():
        message, words = f"{plant.name} has no input '{motor.duty}'", f"inputs of {plant.name}"
        diagnostics.known_or_error("unknown-port", motor.span, message, motor.duty, inputs, words)
        message, words = f"{plant.name} has no output '{motor.position}'", f"outputs of {plant.name}"
        diagnostics.known_or_error("unknown-port", motor.position_span, message, motor.position, outputs, words)
        used = motor.parameters()
        for name, span in (*used, *motor.change):
            if name not in known:
                hint = did_you_mean(name, [p.name for p in plant.parameters], f"parameters of {plant.name}")
                diagnostics.error("unknown-parameter", span, f"{plant.name} has no parameter '{name}'", hint=hint)
        for name, span in motor.change:
            if name in known and known[name] not in {known.get(each) for each, _ in used}:
                message = f"no formula of this motor has the parameter '{name}'"
                hint = "name a parameter that is in a formula"
                diagnostics.error("wrong-value", span, message, hint=hint)


def parameter_names(plant: Model) -> dict[str, str]:
    """The parameters' names by all names that bindings can write: ``.`` can be written for ``\\``."""
    names = {parameter.name: parameter.name for parameter in plant.parameters}
    for parameter in plant.parameters:
        names.setdefault(parameter.name.replace("\\", "."), parameter.name)
    return names
