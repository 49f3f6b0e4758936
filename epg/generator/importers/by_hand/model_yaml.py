# SPDX-License-Identifier: Apache-2.0
"""The common part of all kinds of ``model.yaml``: the name of the file, and the step."""

from __future__ import annotations

from fractions import Fraction

from epg.generator.diagnostics import Diagnostics
from epg.generator.documents.schema import quantity_of
from epg.generator.models.assignments import is_step
from epg.generator.source import YamlNode

FILE_NAME = "model.yaml"


def step_of(node: YamlNode, diagnostics: Diagnostics) -> Fraction | None:
    """The step of a model in seconds; None after reporting that ``node`` cannot be one."""
    value = quantity_of(node, "time", diagnostics)
    if value is None:
        return None
    step = Fraction(value)
    if not is_step(step):
        words = "must be more than 0" if step <= 0 else "must be from 1 ns to 1000000 s"
        diagnostics.error("out-of-range", node.span, f"the step {words}", hint="write for example '1 ms'")
        return None
    return step
