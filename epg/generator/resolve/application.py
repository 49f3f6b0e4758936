# SPDX-License-Identifier: Apache-2.0
"""The application: the result of model, target configuration and bindings together, with every choice made."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import field
from fractions import Fraction
from pathlib import Path

from epg.generator.catalog.catalog import Computer, KindPort
from epg.generator.check.bindings import ParameterSetting
from epg.generator.check.communication import Communication
from epg.generator.check.configuration import Component, Control
from epg.generator.check.other_code import NO_OTHER_CODE, OtherCode
from epg.generator.dataclass import dataclass
from epg.generator.models.model import Model, Port
from epg.generator.resolve.allocation import Assignment
from epg.generator.resolve.parameters import RosParameters
from epg.generator.source import Span


@dataclass(frozen=True)
class ConversionStep:
    """One step of a conversion: ``value * scale + offset``, then limited to ``limits``.

    ``reason`` names its origin: ``components.encoder_pan``, ``inputs.position_pan`` or ``rad -> deg``.
    """

    scale: Fraction | float = Fraction(1)
    offset: float = 0.0
    limits: tuple[float, float] | None = None
    reason: str = ""


@dataclass(frozen=True)
class ResolvedComponent(Component):
    """A component with its hardware.

    For topics, ``value_index`` maps ports to the value indices in the exchange, counted per direction; ``first_index``
    is the smallest one, or None.
    """

    claims: Mapping[str, Assignment]
    value_index: Mapping[str, int]

    @property
    def first_index(self) -> int | None:
        return min(self.value_index.values(), default=None)


@dataclass(frozen=True)
class Wire:
    """A model port and the component port that it is bound to.  The value passes ``steps`` in their order.

    ``unit`` is the unit of the value at the component, empty if it is not known.
    """

    port: Port
    component: ResolvedComponent
    component_port: KindPort
    steps: tuple[ConversionStep, ...]
    unit: str
    span: Span


@dataclass(frozen=True)
class Followed:
    """The measured value that a setpoint follows: the value at the component of ``measured`` after ``step``.

    ``guard`` is the component that guards the axis, empty if there is none.  ``range`` are the values that the setpoint
    can have because of the axis.
    """

    measured: Wire
    step: ConversionStep
    guard: str = ""
    range: tuple[float, float] | None = None


@dataclass(frozen=True)
class SetpointRules:
    """The rules of a setpoint.  All values are in the unit in which it is sent; ``unit`` is empty if it is not known.

    ``timeout`` is in seconds, ``rate_limit`` in units per second; 0 switches each of them off.  If ``fresh``, values
    that were received before the target was enabled do not act.  A value outside of ``limits`` is refused.
    """

    initial: float
    rate_limit: float
    timeout: Fraction
    on_timeout: str
    fresh: bool
    unit: str
    limits: tuple[float, float] | None
    followed: Followed | None


@dataclass(frozen=True)
class TopicValue:
    """One value of a message: its name in messages to the user, the component's port, and its value index.

    ``setpoint`` is the fault handling of a subscribed value.
    """

    name: str
    port: str
    index: int
    setpoint: SetpointRules | None = None


@dataclass(frozen=True)
class Topic:
    """One topic.  ``key`` is the key of the ``.tcf`` that makes it: ``components.pan_publisher``.

    ``durability`` is "volatile" or "transient_local"; ``deadline`` and ``lifespan`` are in seconds, 0 for none.
    ``role`` is "values", "enable", "diagnostics", "parameters" or "echo".  ``index`` is the index of the first value;
    for the subscription of an echo, it is the number of the publication that answers.  ``trigger`` is "period"
    (``period`` in seconds), "cycles" (every ``cycles`` control cycles) or "change".
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
    durability: str = "volatile"
    deadline: Fraction = Fraction(0)
    lifespan: Fraction = Fraction(0)


@dataclass(frozen=True)
class Plant:
    """A simulated plant.  Its inputs come from actuators, and its outputs drive sensors.

    ``library`` is empty for the plant of one target.  For the plant of a system it is the name of the plant's library,
    and ``model`` has only the ports of this target.
    """

    model: Model
    inputs: tuple[Wire, ...]
    outputs: tuple[Wire, ...]
    parameters: Mapping[str, float]
    steps_per_period: int = 1
    library: str = ""


@dataclass(frozen=True)
class Application:
    """One target, ready to be emitted.

    ``period`` is the control period in seconds.  The model runs in every ``step_divider``-th control cycle.
    ``parameters`` are the values that replace exported ones.  ``ros_parameters`` is None if the target serves none.
    """

    name: str
    target: Computer
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
    parameter_settings: Mapping[str, ParameterSetting]
    ros_parameters: RosParameters | None
    subscriptions: tuple[Topic, ...]
    publications: tuple[Topic, ...]
    fail_safe: ResolvedComponent | None
    tick: Assignment | None
    plant: Plant | None
    period: Fraction
    step_divider: int
    files: tuple[Path, ...] = field(default=())
    absent: tuple[Path, ...] = field(default=())
    others: OtherCode = NO_OTHER_CODE
