# SPDX-License-Identifier: Apache-2.0
"""Folds the steps of a conversion into the steps that the generated code computes."""

from __future__ import annotations

import math
import sys
from collections.abc import Sequence

from epg.generator.resolve.application import ConversionStep


def folded(steps: Sequence[ConversionStep]) -> list[ConversionStep]:
    """Joins successive ``steps`` without limits between them into one.

    Raises OverflowError if a factor is outside of the range of a double.
    """
    result: list[ConversionStep] = []
    for step in steps:
        if result and result[-1].limits is None:
            last = result.pop()
            offset = float(last.offset * float(step.scale) + step.offset)
            step = ConversionStep(last.scale * step.scale, offset, step.limits, f"{last.reason}, {step.reason}")
        result.append(step)
    return result


def is_computable(steps: Sequence[ConversionStep]) -> bool:
    """True if a double can hold all factors and offsets, before and after folding.

    Factors must be normal: they must not overflow and must not become 0.
    """
    try:
        return all(_is_normal(float(step.scale)) and math.isfinite(step.offset) for step in (*steps, *folded(steps)))
    except OverflowError:
        return False


def _is_normal(factor: float) -> bool:
    return math.isfinite(factor) and abs(factor) >= sys.float_info.min
