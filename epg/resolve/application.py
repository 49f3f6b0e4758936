# SPDX-License-Identifier: Apache-2.0
"""The application: what the three kinds of file mean together, with nothing left to choose."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from fractions import Fraction
from pathlib import Path

from epg.catalog.catalog import Kind, KindPort, Target
from epg.check.communication import Communication
from epg.check.configuration import Control
from epg.check.uses import Used
from epg.models.model import Model, Port
from epg.resolve.allocation import Assignment
from epg.source import Span


@dataclass(frozen=True)
class Step:
    """One step of a conversion: ``value * scale + offset``, then limited to ``limits``.

    ``reason`` says where it comes from: ``components.encoder_pan``, ``inputs.position_pan`` or ``rad -> deg``.
    """

    scale: Fraction | float = Fraction(1)
    offset: float = 0.0
    limits: tuple[float, float] | None = None
    reason: str = ""


@dataclass(frozen=True)
class ResolvedComponent:
    """A component with its hardware.

    ``value_index`` are the indices of its ports' values in the exchange (topics only), counted per direction;
    ``first_index`` is the first of them.
    """

    name: str
    symbol: str
    kind: Kind
    parameters: Mapping[str, object]
    claims: Mapping[str, Assignment]
    uses: Mapping[str, Used]
    value_index: Mapping[str, int]
    application: str
    span: Span

    @property
    def first_index(self) -> int | None:
        return min(self.value_index.values(), default=None)


@dataclass(frozen=True)
class Wire:
    """A model port and the component port it is bound to; ``steps`` in the order the value takes."""

    port: Port
    component: ResolvedComponent
    component_port: KindPort
    steps: tuple[Step, ...]
    span: Span


@dataclass(frozen=True)
class Setpoint:
    """A subscription's fault handling; times in seconds, ``rate_limit`` in units per second (0: none)."""

    initial: float
    rate_limit: float
    timeout: Fraction
    on_timeout: str


@dataclass(frozen=True)
class TopicValue:
    """One number of a message: its name for people, the component's port, its value index, and a setpoint's faults."""

    name: str
    port: str
    index: int
    setpoint: Setpoint | None = None


@dataclass(frozen=True)
class Topic:
    """One topic.  ``key`` is what makes it: ``components.pan_publisher``, ``control.enable_topic``.

    ``role`` is "values", "enable", "diagnostics" or "echo"; ``index`` is the index of the first value, of an echo's
    subscription the number of the publication that answers.  ``trigger`` is "period" (``period`` in seconds), "cycles"
    (every ``cycles`` control cycles) or "change".
    """

    name: str
    key: str
    role: str
    qos: str
    depth: int
    component: ResolvedComponent | None
    values: tuple[TopicValue, ...]
    index: int
    trigger: str = "period"
    cycles: int = 0
    period: Fraction = Fraction(0)


@dataclass(frozen=True)
class Plant:
    """The simulated plant of a host target: its inputs come from actuators, its outputs drive sensors."""

    model: Model
    inputs: tuple[Wire, ...]
    outputs: tuple[Wire, ...]
    parameters: Mapping[str, float]
    steps_per_period: int


@dataclass(frozen=True)
class Application:
    """One target, ready to be emitted.  ``period`` in seconds; the model runs every ``step_divider``-th cycle."""

    name: str
    target: Target
    target_span: Span
    node: str
    namespace: str
    control: Control
    communication: Communication
    components: tuple[ResolvedComponent, ...]
    model: Model
    inputs: tuple[Wire, ...]
    outputs: tuple[Wire, ...]
    parameters: Mapping[str, float]
    subscriptions: tuple[Topic, ...]
    publications: tuple[Topic, ...]
    fail_safe: ResolvedComponent | None
    tick: Assignment | None
    plant: Plant | None
    period: Fraction
    step_divider: int
    files: tuple[Path, ...] = field(default=())
    absent: tuple[Path, ...] = field(default=())
