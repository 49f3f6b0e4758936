# SPDX-License-Identifier: Apache-2.0
"""Checks a model as a part of a target or a library: the names of its ports, and its number of instances."""

from __future__ import annotations

from epg.diagnostics import Diagnostics
from epg.models.details import FmuExport
from epg.models.model import Model
from epg.source import Span


def check_model_names(model: Model, library: str, diagnostics: Diagnostics) -> None:
    """Reports a port with the name of a macro in the header of the model's ``library`` or of its target."""
    macros = {f"{library}_{word}".upper() for word in ("step_size", "instances", "parameters")}
    macros |= {f"{library.rpartition('_')[0]}_{word}".upper() for word in ("epg_version", "hash")}
    for port in (*model.inputs, *model.outputs):
        if port.identifier in macros:
            message = f"{port.direction} '{port.name}' has the name of a macro in the generated header"
            diagnostics.error("invalid-name", port.span, message, hint="rename the port or the target")


def check_instances(model: Model, instances: int, span: Span, diagnostics: Diagnostics) -> None:
    """Reports a number of ``instances`` that is not possible.

    A model can have several only if it does not keep its state in global variables.
    """
    if instances < 1 or instances > 255:
        diagnostics.error("out-of-range", span, f"the number of instances must be from 1 to 255, not {instances}")
    elif instances > 1 and not model.instantiable:
        is_fmu = isinstance(model.details, FmuExport)
        why = "cannot be instantiated more than once" if is_fmu else "keeps its state in global variables"
        other = ": each call makes its own copy of the code" if is_fmu else ", or export it as a C++ class"
        diagnostics.error(
            "single-instance",
            model.span,
            f"{model.name} ({model.origin}) {why}: it can have only one instance",
            hint="call epg_add_model once for each instance, with different names" + other,
        )
