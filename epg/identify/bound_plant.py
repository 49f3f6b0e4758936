# SPDX-License-Identifier: Apache-2.0
"""The parameters of a plant that follow from the identified values of one of its motors.

The bindings of the plant have a section ``motors`` with formulas (:mod:`epg.generator.check.motors`).  They are solved
for the parameters that may change, and the new values replace those in the section ``parameters``.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from contextlib import suppress
from pathlib import Path
from typing import Any

from epg.edit.tcf import set_value
from epg.generator.check.bindings import Binding, Bindings, load_bindings
from epg.generator.check.formulas import FormulaError
from epg.generator.check.motors import Motor
from epg.generator.dataclass import dataclass
from epg.generator.diagnostics import Diagnostics
from epg.generator.documents.text_file import NO_DRAFTS, Drafts
from epg.generator.importers import load_model
from epg.generator.models.model import Model
from epg.generator.resolve.motors import check_motors, parameter_names
from epg.generator.resolve.parameters import parameter_settings, parameter_values
from epg.generator.resolve.resolve import check_model_name
from epg.generator.source import Span
from epg.identify.fit import Fit

DIGITS = 5
"""Significant digits of a parameter that is written: its error is larger than what is cut off."""
_SMALL = 1e-3  # the scale of a friction or dead zone of 0


class NoSolution(Exception):
    """The formulas have no solution that the plant can have, for the reason in the text."""


@dataclass(frozen=True)
class BoundPlant:
    """A plant with its bindings.  ``values`` are the present values of its parameters, by their names in the plant."""

    model: Model
    bindings: Bindings
    values: Mapping[str, float]

    def known(self) -> dict[str, float]:
        """The present values by all names that formulas can have."""
        return {name: self.values[own] for name, own in parameter_names(self.model).items()}

    def unit(self, motor: Motor) -> str:
        """The unit of a motor's position."""
        return next((port.unit for port in self.model.outputs if port.name == motor.position), "")


def load_plant(folder: Path, bindings: Path, diagnostics: Diagnostics, drafts: Drafts = NO_DRAFTS) -> BoundPlant | None:
    """The plant in ``folder`` with these ``bindings``.  Reports all mistakes, as ``epg check`` does."""
    before = diagnostics.error_count
    model = load_model(folder, diagnostics)
    plant_bindings = load_bindings(bindings, diagnostics, drafts=drafts)
    if model is None or plant_bindings is None:
        return None
    check_model_name(plant_bindings, model, diagnostics)
    settings = parameter_settings(plant_bindings, model, diagnostics)
    check_motors(plant_bindings, model, diagnostics)
    if not plant_bindings.motors:
        message = "these bindings have no section 'motors'"
        hint = "write the motors' formulas: see docs/identify.md"
        diagnostics.error("no-motors", Span(str(bindings)), message, hint=hint)
    values = {parameter.name: parameter.value for parameter in model.parameters} | parameter_values(settings)
    return BoundPlant(model, plant_bindings, values) if diagnostics.error_count == before else None


def changed_text(text: str, plant: BoundPlant, changes: Mapping[str, float]) -> str:
    """The text of the plant's bindings with new values of parameters.

    :raises CannotEdit: EPG cannot edit the form of the text
    """
    names = parameter_names(plant.model)
    written = {names[name]: name for name in plant.bindings.parameters}
    for name, value in changes.items():
        path = ["parameters", written.get(name, name)]
        node = plant.bindings.root.get(*path)
        if node is not None and node.is_mapping:
            path.append("value")
        text = set_value(text, str(plant.bindings.path), path, value)
    return text


def motor_for(bindings: Bindings, signal: str) -> Motor | None:
    """The motor of a recorded duty: that whose input, or whose actuator, has the last part of the signal's name.

    Without one, the only motor of the plant, or None if it has several.
    """
    last = signal.rpartition(".")[2]
    for motor in bindings.motors.values():
        bound = bindings.inputs.get(motor.duty)
        if last == motor.duty or (bound is not None and last == bound[1].component):
            return motor
    return next(iter(bindings.motors.values())) if len(bindings.motors) == 1 else None


def wanted_values(motor: Motor, bindings: Bindings, fit: Fit, duty: str, position: str) -> list[float]:
    """The identified values as the plant has them: in the order of the motor's formulas.

    Signals of the plant have its units.  All others have those of components; the plant's wires convert them.
    """
    duty_scale = 1.0 if duty.startswith("plant.") else _scale(_input(bindings, motor))
    position_scale = 1.0 if position.startswith("plant.") else _scale(_output(bindings, motor))
    found = {
        "gain": fit.gain.value / (duty_scale * position_scale),
        "time_constant": fit.time_constant.value,
        "friction": fit.friction.value * abs(duty_scale),
        "dead_zone": fit.friction.value * abs(duty_scale),
    }
    return [found[quantity] for quantity in motor.formulas]


def _input(bindings: Bindings, motor: Motor) -> Binding | None:
    bound = bindings.inputs.get(motor.duty)
    return bound[1] if bound else None


def _output(bindings: Bindings, motor: Motor) -> Binding | None:
    bound = bindings.outputs.get(motor.position)
    return bound[1][0] if bound and bound[1] else None


def _scale(binding: Binding | None) -> float:
    return float(binding.conversion.scale) if binding is not None and binding.conversion.scale is not None else 1.0


def solved(plant: BoundPlant, motor: Motor, wanted: list[float]) -> dict[str, float]:
    """The new values of the parameters in ``change`` with which the formulas have the ``wanted`` values.

    Newton's method from the present values finds the nearest solution.

    :raises NoSolution: there is none, or a parameter would change its sign
    :raises FormulaError: a formula has no value for the present parameters
    """
    import numpy as np

    names = parameter_names(plant.model)
    change = [names[name] for name, _ in motor.change]
    scale = np.array([abs(value) or _SMALL for value in wanted])

    def misses(values: Any) -> Any:
        new = dict(zip(change, np.asarray(values).tolist(), strict=True))
        known = {name: new.get(own, plant.values[own]) for name, own in names.items()}
        return (np.array(motor.values(known)) - np.array(wanted)) / scale

    old = np.array([plant.values[name] for name in change])
    present, miss = old.copy(), misses(old)
    sizes = np.where(old == 0.0, 1.0, np.abs(old))
    for _ in range(50):
        if np.abs(miss).max() < 1e-10:
            break
        step = np.linalg.lstsq(_slopes(misses, present, miss, sizes), -miss, rcond=None)[0]
        nearer = _nearer(misses, present, step, miss)
        if nearer is None:
            break
        present, miss = nearer
    if np.abs(miss).max() > 1e-6:
        quantity = list(motor.formulas)[int(np.abs(miss).argmax())]
        raise NoSolution(f"no values of {', '.join(change)} give the identified {quantity.replace('_', ' ')}")
    present[np.abs(present) < 1e-9 * sizes] = 0.0
    result = dict(zip(change, (float(f"{value:.{DIGITS}g}") + 0.0 for value in present.tolist()), strict=True))
    for name, before in zip(change, old.tolist(), strict=True):
        if result[name] * before < 0.0 or (result[name] == 0.0 and name != change[-1]):
            raise NoSolution(f"'{name}' would become {result[name]:g}; it is {before:g}")
    return result


def _slopes(misses: Callable[[Any], Any], present: Any, miss: Any, sizes: Any) -> Any:
    """The slopes of ``misses``, a column per value."""
    import numpy as np

    slopes = np.empty((len(miss), len(present)))
    for at in range(len(present)):
        beside = present.copy()
        beside[at] += 1e-7 * sizes[at]
        slopes[:, at] = (misses(beside) - miss) / (beside[at] - present[at])
    return slopes


def _nearer(misses: Callable[[Any], Any], present: Any, step: Any, miss: Any) -> tuple[Any, Any] | None:
    """The values after the step, or after a part of it, which miss less than ``miss``; None if there are none."""
    share = 1.0
    while share > 1e-4:
        new = present + share * step
        with suppress(FormulaError):
            left = misses(new)
            if abs(left).max() < abs(miss).max():
                return new, left
        share /= 2.0
    return None
