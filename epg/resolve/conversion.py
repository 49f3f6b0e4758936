# SPDX-License-Identifier: Apache-2.0
"""Steps of a conversion as the generated code computes them."""

from __future__ import annotations

import math
import sys
from collections.abc import Sequence

from epg.resolve.application import Step


def folded(steps: Sequence[Step]) -> list[Step]:
    """``steps`` with those that have no limits between them made one.  Raises OverflowError beyond C's doubles."""
    result: list[Step] = []
    for step in steps:
        if result and result[-1].limits is None:
            last = result.pop()
            offset = float(last.offset * float(step.scale) + step.offset)
            step = Step(last.scale * step.scale, offset, step.limits, f"{last.reason}, {step.reason}")
        result.append(step)
    return result


def is_computable(steps: Sequence[Step]) -> bool:
    """Whether every factor and offset, alone and folded, is a normal double: no factor overflows, or becomes 0."""
    try:
        return all(_is_normal(float(step.scale)) and math.isfinite(step.offset) for step in (*steps, *folded(steps)))
    except OverflowError:
        return False


def _is_normal(factor: float) -> bool:
    return math.isfinite(factor) and abs(factor) >= sys.float_info.min
