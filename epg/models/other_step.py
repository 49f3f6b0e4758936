# SPDX-License-Identifier: Apache-2.0
"""Models with another step than that of their files."""

from __future__ import annotations

import re
from dataclasses import replace
from fractions import Fraction

from epg.models.assignments import exact_number
from epg.models.details import CFunctionExport, FmuExport, TokensExport
from epg.models.model import Model


def with_step(model: Model, step: Fraction) -> Model | None:
    """``model`` with a step of ``step`` seconds; None if its code has a fixed step.

    An integration method takes any step.  An FMU takes multiples of its own one.
    """
    if step == model.step:
        return model
    details = model.details
    changed = replace(model, step=step)
    if isinstance(details, FmuExport):
        return changed if (step / model.step).denominator == 1 else None
    if model.method == "Discrete":
        return None
    if isinstance(details, TokensExport):
        return changed
    if isinstance(details, CFunctionExport) and not details.instance_type:
        return _with_variable(changed, details, model.step)
    return None


def _with_variable(model: Model, details: CFunctionExport, old: Fraction) -> Model | None:
    """The model whose variable with the step is set by its initial value alone: ``XXDouble xx_step_size = 0.001;``."""
    named = [variable for variable in details.variables if "step_size" in variable.name]
    if len(named) != 1 or exact_number(named[0].value) != old:
        return None
    assigned = re.compile(rf"(?<!\w){re.escape(named[0].name)}\s{{0,80}}=(?!=)", re.ASCII)
    if sum(len(assigned.findall(code.file.code)) for code in details.linked.units) != 1:
        return None
    value = repr(float(model.step))
    variables = tuple(replace(v, value=value) if v is named[0] else v for v in details.variables)
    return replace(model, details=replace(details, variables=variables))
