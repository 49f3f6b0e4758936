# SPDX-License-Identifier: Apache-2.0
"""What templates see of an application's components, wires and pins."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from typing import Any

from epg.emit.text import Code


@dataclass(frozen=True)
class UseView:
    """Another component that one names: the C expressions for its value, and for how often that was reset.

    ``value`` is what a sensor gives or what a drive is given at present; empty for a topic.
    """

    name: str
    value: Code
    resets: Code


@dataclass(frozen=True)
class ValueView:
    """One number of a component's topic: the port, with element and part as in :class:`~epg.catalog.kind.KindPort`."""

    port: str
    element: str
    part: str
    index: int


@dataclass(frozen=True)
class ComponentView:
    """A component as templates of its kind see it; names that are printed are code already.

    ``period`` is that of the control cycle, ``write_period`` the one at which actuators are written, both in seconds.
    ``values`` are the numbers of its topic in the order of the message, ``value_index`` their indices by port,
    ``first_index`` the first one.
    """

    name: str
    symbol: Code
    parameters: Mapping[str, object]
    claims: Mapping[str, Any]
    first_index: int | None
    application: Code
    period: Fraction
    write_period: Fraction
    value_index: Mapping[str, int] = field(default_factory=dict)
    values: Sequence[ValueView] = ()
    uses: Mapping[str, UseView] = field(default_factory=dict)


@dataclass(frozen=True)
class Part:
    """What one component contributes to the places of the generation order."""

    component: ComponentView
    number: int
    globals: Code
    start: Code
    sample: Code
    check: Code
    safe: Code
    probes: Mapping[str, Code]


POINTS = ("cycle", "inputs", "model", "outputs")
"""Points of the control cycle at which a kind may have statements: its macro ``probe(c, point)``."""


@dataclass(frozen=True)
class Arrival:
    """Statements for when a setpoint has arrived, or a publication is about to leave."""

    component: str
    index: int  # of the topic's first setpoint, or of the publication
    statement: Code


@dataclass(frozen=True)
class InputView:
    """An assignment to a model input."""

    name: str
    source: str
    member: Code
    value: Code


@dataclass(frozen=True)
class OutputView:
    """Statements that hand a model output on: what can be done before its instant, if anything, and the rest."""

    name: str
    sink: str
    prepare: Code
    statement: Code


@dataclass(frozen=True)
class OutputPin:
    """A pin that a component drives; ``high`` is C that says whether its level is high while nothing is to move."""

    component: str
    signal: str
    pin: int
    high: Code


@dataclass(frozen=True)
class InputPin:
    """A pin that the component ``name`` reads; ``invert``: as 1 when it is low."""

    name: str
    pin: int
    invert: bool


@dataclass(frozen=True)
class SafeState:
    """Which of a component's outputs must be low and which must be high, one bit each, the first one lowest."""

    low: int
    high: int


@dataclass(frozen=True)
class OutputGroup:
    """The output pins of one component, ``count`` of them from the ``first`` on, and its safe states."""

    component: str
    first: int
    count: int
    states: tuple[SafeState, ...]
