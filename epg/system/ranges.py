# SPDX-License-Identifier: Apache-2.0
"""The ranges of the values at a topic that the limits of wires imply."""

from __future__ import annotations

import math

from epg.generator.resolve.application import ConversionStep

Range = tuple[float, float]
"""The lowest and the highest value; infinite without a limit."""

ALL: Range = (-math.inf, math.inf)


def sent_range(steps: tuple[ConversionStep, ...]) -> Range:
    """The values that can leave a wire from a model to a topic."""
    possible = ALL
    for step in steps:
        possible = _cut(_moved(possible, float(step.scale), step.offset), step.limits or ALL)
    return possible


def received_range(steps: tuple[ConversionStep, ...]) -> Range:
    """The values of a topic that the limits of a wire to a model permit."""
    possible = ALL
    for step in reversed(steps):
        scale = float(step.scale)
        possible = _moved(_cut(possible, step.limits or ALL), 1 / scale, -step.offset / scale)
    return possible


def _moved(values: Range, scale: float, offset: float) -> Range:
    ends = sorted(end * scale + offset for end in values)
    return ends[0], ends[1]


def _cut(values: Range, limits: Range) -> Range:
    return max(values[0], limits[0]), min(values[1], limits[1])
