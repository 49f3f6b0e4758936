# SPDX-License-Identifier: Apache-2.0
"""The components, wires and pins of an application, as templates see them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import field
from fractions import Fraction
from typing import Any

from epg.generator.dataclass import dataclass
from epg.generator.emit.text import Code


@dataclass(frozen=True)
class UseView:
    """A component that another component uses.

    ``value`` is a C expression: the value of a sensor, or the duty that a drive is given at present.  It is empty for a
    topic.  ``resets`` is a C expression that counts the resets of the value.
    """

    name: str
    value: Code
    resets: Code


@dataclass(frozen=True)
class ValueView:
    """One value of a component's topic.

    ``element`` and ``part`` are those of :class:`~epg.generator.catalog.kind.KindPort`.  ``index`` is the value index.
    """

    port: str
    element: str
    part: str
    index: int


@dataclass(frozen=True)
class ComponentView:
    """A component as the template of its kind sees it.  Members of the type ``Code`` can be printed without a filter.

    ``period`` is the control period, ``write_period`` the time between two writes of actuators, both in seconds.
    ``values`` are the values of the component's topic in the order of the message.  ``value_index`` has their value
    indices by port, and ``first_index`` is the first of them; it is None for a component without a topic.
    ``value_names`` are the constants of these indices, by port, and ``faults`` those of the kind's faults, by name.
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
    value_names: Mapping[str, Code] = field(default_factory=dict)
    uses: Mapping[str, UseView] = field(default_factory=dict)
    faults: Mapping[str, Code] = field(default_factory=dict)


@dataclass(frozen=True)
class ComponentCode:
    """The code that one component contributes to each place of the generation order."""

    component: ComponentView
    constant: Code  # the component's index
    globals: Code
    start: Code
    sample: Code
    check: Code
    safe: Code
    probes: Mapping[str, Code]


POINTS = ("cycle", "inputs", "model", "outputs")
"""The points of the control cycle at which a kind can have statements, by its macro ``probe(c, point)``."""


@dataclass(frozen=True)
class Arrival:
    """Statements of a component that run when a setpoint has arrived, or before a publication is sent."""

    component: str
    index: int  # the value index of the topic's first setpoint, or the index of the publication
    statement: Code


@dataclass(frozen=True)
class InputView:
    """An assignment to a model input.  ``source`` describes the wire in a comment, ``value`` is a C expression."""

    name: str
    source: str
    member: Code
    value: Code


@dataclass(frozen=True)
class FollowedView:
    """The measured value that a setpoint follows: a C expression, the signal, and the component that guards its axis.

    ``guard`` is empty if no component guards it.
    """

    setpoint: str
    signal: str
    value: Code
    guard: str


@dataclass(frozen=True)
class OutputView:
    """Statements that write a model output.  ``sink`` describes the wire in a comment.

    ``prepare`` does the work that is not time-critical, and can be empty.  ``statement`` then writes the output.
    """

    name: str
    sink: str
    prepare: Code
    statement: Code


@dataclass(frozen=True)
class SafeState:
    """One safe state: bit masks of the outputs of a component that must be low, and of those that must be high.

    The lowest bit belongs to the first output.
    """

    low: int
    high: int


@dataclass(frozen=True)
class OutputGroup:
    """The output pins of one component and its safe states.

    ``first`` is the index of its first pin in the list of all output pins, ``count`` the number of its pins.
    """

    component: str
    first: int
    count: int
    states: tuple[SafeState, ...]
