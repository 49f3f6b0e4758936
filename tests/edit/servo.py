# SPDX-License-Identifier: Apache-2.0
"""A model for tests of bindings, in which only the names of ports matter."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from pathlib import Path
from typing import cast

from epg.generator.models.code import ModelCode
from epg.generator.models.model import Model, Port
from epg.generator.source import Span

HERE = Span("model.yaml", 1, 1, 2)


def model_of(inputs: Sequence[str], outputs: Sequence[str]) -> Model:
    """A model with ports of these names."""

    def ports(names: Sequence[str], direction: str) -> tuple[Port, ...]:
        return tuple(Port(name, f"port_{i}", direction, "", "real", i, HERE) for i, name in enumerate(names))

    return Model(
        name="Servo",
        origin="hand-written",
        language="c",
        version="",
        method="",
        step=Fraction(1, 1000),
        inputs=ports(inputs, "input"),
        outputs=ports(outputs, "output"),
        parameters=(),
        directory=Path(),
        files=(),
        span=HERE,
        code=cast(ModelCode, None),  # the tests generate nothing
    )
