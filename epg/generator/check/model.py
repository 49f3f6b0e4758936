# SPDX-License-Identifier: Apache-2.0
"""Checks a model as a part of a target or a library: the names of its ports, and its number of instances."""

from __future__ import annotations

from epg.generator.diagnostics import Diagnostics
from epg.generator.models.model import Model
from epg.generator.source import Span


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
        message = f"{model.name} ({model.origin}) {model.code.alone}: it can have only one instance"
        hint = f"call epg_add_model once for each instance, with different names{model.code.other_instance}"
        diagnostics.error("single-instance", model.span, message, hint=hint)
