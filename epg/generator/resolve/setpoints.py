# SPDX-License-Identifier: Apache-2.0
"""The setpoints of an application: their ages, limits, and the measured values that they follow.

The limits of a setpoint act when a value is received, on the value as it was sent: a value outside is refused, never
changed.  They are therefore computed back through the conversions of all wires of the setpoint, and generated code does
not limit the values of these wires again.
"""

from __future__ import annotations

import math
import sys
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from fractions import Fraction

from epg.generator.catalog.kind import KindAxis
from epg.generator.check.bindings import Bindings, Follows
from epg.generator.check.configuration import Component
from epg.generator.dataclass import dataclass
from epg.generator.diagnostics import Diagnostics, Note, did_you_mean
from epg.generator.documents.schema import extended_from
from epg.generator.quantity import IN_MOTION, conversion_factor, dimension_of, normal_unit
from epg.generator.resolve.application import ConversionStep, Followed, ResolvedComponent, SetpointRules, Wire
from epg.generator.resolve.conversion import is_computable
from epg.generator.source import Span

MOTION_TIMEOUT, MOTION_ACTION = Fraction(1, 2), "zero"
"""The defaults of setpoints that keep something moving: their age in seconds, and the reaction to an older one."""

Setpoints = Mapping[tuple[str, str], SetpointRules]
"""The setpoints by the names of component and port."""


def setpoints_of(
    components: Mapping[str, ResolvedComponent], inputs: Sequence[Wire], bindings: Bindings, diagnostics: Diagnostics
) -> Setpoints:
    """The setpoints of all subscriptions.  Reports mistakes in their limits, and in the values that they follow."""
    result = {}
    for component in components.values():
        if component.kind.communication == "subscribe":
            for port in component.value_index:
                bound = [w for w in inputs if (w.component.name, w.component_port.name) == (component.name, port)]
                end = _End(component, port, bound)
                followed = _followed(end, inputs, bindings, components, diagnostics)
                result[component.name, port] = _setpoint(end, followed, diagnostics)
    _check_others(inputs, bindings, diagnostics)
    return result


def computed_steps(wire: Wire) -> Sequence[ConversionStep]:
    """The steps of a wire that generated code computes: those of a setpoint without limits, which have acted before."""
    if wire.component.kind.communication != "subscribe":
        return wire.steps
    return [replace(step, limits=None) for step in wire.steps]


@dataclass(frozen=True)
class _End:
    """A port of a subscriber, and the wires from it to inputs of the model."""

    component: ResolvedComponent
    port: str
    wires: Sequence[Wire]

    @property
    def name(self) -> str:
        """The end as bindings write it."""
        port = next(p for p in self.component.kind.ports if p.name == self.port)
        return self.component.kind.reference(self.component.name, port)

    @property
    def units(self) -> list[str]:
        """The units that the kind or the component states for the value, else those of the model's ports."""
        port = next(p for p in self.component.kind.ports if p.name == self.port)
        own = port.unit or self.component.conversion.unit
        return [own] if own else [unit for wire in self.wires if (unit := wire.port.unit)]

    @property
    def moves(self) -> bool:
        """True if the value keeps something moving until it changes."""
        return any(dimension_of(unit) in IN_MOTION for unit in self.units)

    @property
    def unit(self) -> str:
        """The unit of the value as it is sent; empty if it is not known."""
        return next((wire.unit for wire in self.wires if wire.unit), next(iter(self.units), ""))


def _setpoint(end: _End, followed: Followed | None, diagnostics: Diagnostics) -> SetpointRules:
    parameters = end.component.parameters
    timeout, action = (MOTION_TIMEOUT, MOTION_ACTION) if end.moves else (Fraction(0), "hold")
    stated = parameters.get("timeout")
    if stated is not None:
        assert isinstance(stated, (int, Fraction))
        timeout = Fraction(stated)
    setpoint = SetpointRules(
        initial=_number(parameters.get("initial") or 0),
        rate_limit=_number(parameters.get("rate_limit") or 0),
        timeout=timeout,
        on_timeout=str(parameters.get("on_timeout") or action),
        fresh=end.moves or followed is not None,
        unit=end.unit,
        limits=_limits(end, followed, diagnostics),
        followed=followed,
    )
    _check_limits(end, setpoint, diagnostics)
    if end.moves and (not setpoint.timeout or setpoint.on_timeout == "hold"):
        _warn_of_hold(end, setpoint, diagnostics)
    elif stated is None:
        _note_unknown(end, diagnostics)
    return setpoint


def _number(value: object) -> float:
    assert isinstance(value, (int, float, Fraction))
    return float(value)


# Ages


def _warn_of_hold(end: _End, setpoint: SetpointRules, diagnostics: Diagnostics) -> None:
    key = "on_timeout" if setpoint.timeout else "timeout"
    node = end.component.node[key]
    message = (
        f"if its sender stops, '{end.component.name}' keeps its last {_dimension(end)}: "
        f"the robot moves on until somebody disables it"
    )
    hint = "write 'on_timeout: zero' or 'on_timeout: disable', with a 'timeout', unless you want this"
    diagnostics.warning("setpoint-hold", node.span, message, hint=hint, notes=extended_from(node))


def _note_unknown(end: _End, diagnostics: Diagnostics) -> None:
    """Notes that EPG does not know the dimension of a real number, which could keep something moving."""
    if not end.wires or any(dimension_of(unit) for unit in end.units if unit):
        return
    if any(wire.port.type != "real" for wire in end.wires):
        return  # a switch or a number of something is not a velocity
    message = f"'{end.component.name}' has no timeout: neither its unit nor that of the model's port says what it is"
    hint = "set 'unit' (for a share or a duty: unit: \"%\"), or 'timeout' and 'on_timeout'"
    diagnostics.note("setpoint-without-unit", end.component.span, message, hint=hint)


def _dimension(end: _End) -> str:
    found = next(dimension for unit in end.units if (dimension := dimension_of(unit)) in IN_MOTION)
    return "duty" if found == "ratio" else str(found).split()[-1]  # one message for all velocities of a Twist


# Limits


def _limits(end: _End, followed: Followed | None, diagnostics: Diagnostics) -> tuple[float, float] | None:
    """The limits of the value as it is sent: those of all wires together, else the range of its axis."""
    pairs = [pair for wire in end.wires for pair in _limits_before(wire.steps)]
    if not pairs:
        return followed.range if followed is not None else None
    low, high = max(pair[0] for pair in pairs), min(pair[1] for pair in pairs)
    if low >= high:
        message = f"no value of '{end.name}' is within all of its limits"
        spans = [w.span for w in end.wires]
        notes = [Note("bound here, too", span) for span in spans[1:]]
        diagnostics.error("out-of-range", spans[0], message, hint="state limits that overlap", notes=notes)
        return None
    return low, high


def _limits_before(steps: Iterable[ConversionStep]) -> Iterable[tuple[float, float]]:
    """The limits of a wire, each for the value before the first step."""
    scale: Fraction | float = Fraction(1)
    offset: Fraction | float = Fraction(0)
    for step in steps:
        scale, offset = scale * step.scale, offset * step.scale + _exact(step.offset)
        if step.limits is not None:
            low, high = sorted(_double((_exact(limit) - offset) / scale) for limit in step.limits)
            yield low, high


def _exact(number: float) -> Fraction:
    """The decimal number that was written, so that 0.1 is a tenth."""
    return Fraction(repr(float(number)))


def _double(number: Fraction | float) -> float:
    """The nearest finite double."""
    try:
        return min(max(float(number), -sys.float_info.max), sys.float_info.max)
    except OverflowError:
        return math.copysign(sys.float_info.max, number)


def _check_limits(end: _End, setpoint: SetpointRules, diagnostics: Diagnostics) -> None:
    """Reports values outside of the limits that the setpoint would have without a sender."""
    node, limits = end.component.node, setpoint.limits
    if limits is None:
        return
    values = [] if setpoint.followed is not None else [(setpoint.initial, "initial", "before the first message")]
    if setpoint.timeout and setpoint.on_timeout == "zero":
        values.append((0.0, "on_timeout", "after its timeout"))
    for value, key, when in values:
        if not limits[0] <= value <= limits[1]:
            message = f"'{end.name}' is {value:g} {when}, which is outside of its limits {limits[0]:g} to {limits[1]:g}"
            span = node.key_span(key) if key in node else end.component.span
            notes = extended_from(node[key]) if key in node else ()
            hint = f"set '{key}' to a value within the limits" if key == "initial" else "set 'on_timeout' to 'disable'"
            diagnostics.error("out-of-range", span, message, hint=f"{hint}, or other limits", notes=notes)


# Following


def _followed(
    end: _End,
    inputs: Sequence[Wire],
    bindings: Bindings,
    components: Mapping[str, Component],
    diagnostics: Diagnostics,
) -> Followed | None:
    """The measured value that the bindings of a setpoint name; None without one, or after reporting a mistake."""
    stated = [(wire, follows) for wire in end.wires if (follows := bindings.inputs[wire.port.name][1].follows)]
    if not stated:
        return None
    wire, follows = stated[0]
    _refuse_others(end, follows, [other for _, other in stated[1:]], diagnostics)
    measured = _measured(follows, inputs, bindings, diagnostics)
    if measured is None:
        return None
    conversion = _conversion(measured, wire, bindings, follows.span, diagnostics)
    return None if conversion is None else _with_axis(Followed(measured, conversion), components)


def _measured(follows: Follows, inputs: Sequence[Wire], bindings: Bindings, diagnostics: Diagnostics) -> Wire | None:
    """The wire of a measured value to the input that a setpoint follows; None after reporting that it is not one."""
    choices = [w.port.name for w in inputs if _is_measured(w)]
    measured = next((w for w in inputs if w.port.name == follows.port), None)
    if measured is None:
        if follows.port not in bindings.inputs:  # otherwise the error about its binding says enough
            message = f"there is no bound input '{follows.port}' to follow"
            hint = did_you_mean(follows.port, choices, "measured values")
            diagnostics.error("wrong-follows", follows.span, message, hint=hint)
        return None
    if not _is_measured(measured):
        message = f"a setpoint follows a measured number, but '{follows.port}' is bound to '{_reference(measured)}'"
        hint = f"possible: {', '.join(choices)}" if choices else "remove 'follows'"
        diagnostics.error("wrong-follows", follows.span, message, hint=hint)
        return None
    return measured


def _refuse_others(end: _End, first: Follows, others: Iterable[Follows], diagnostics: Diagnostics) -> None:
    """Reports wires of a setpoint that follow another value than its ``first`` wire."""
    for other in others:
        if other.port != first.port:
            message = f"'{end.name}' follows '{first.port}' already"
            notes = [Note("stated here", first.span)]
            diagnostics.error("wrong-follows", other.span, message, hint="remove one of the two", notes=notes)


def _check_others(inputs: Sequence[Wire], bindings: Bindings, diagnostics: Diagnostics) -> None:
    """Reports ``follows`` on inputs that are not setpoints."""
    for wire in inputs:
        follows = bindings.inputs[wire.port.name][1].follows
        if follows is not None and wire.component.kind.communication != "subscribe":
            message = f"'{wire.port.name}' is not a setpoint: '{_reference(wire)}' is not a topic that is received"
            diagnostics.error("wrong-follows", follows.span, message, hint="remove 'follows'")


def _is_measured(wire: Wire) -> bool:
    return wire.port.type == "real" and wire.component_port.type == "real" and not wire.component.kind.communication


def _reference(wire: Wire) -> str:
    return wire.component.kind.reference(wire.component.name, wire.component_port)


def _conversion(
    measured: Wire, wire: Wire, bindings: Bindings, span: Span, diagnostics: Diagnostics
) -> ConversionStep | None:
    """The step from the component's measured value to the setpoint as it is sent, so that both mean the same."""
    units = [_model_unit(w, bindings) for w in (measured, wire)]
    factor: Fraction | float = Fraction(1)
    if all(units) and units[0] != units[1]:
        if dimension_of(units[0]) is None or dimension_of(units[0]) != dimension_of(units[1]):
            if any(_is_refused(w, bindings) for w in (measured, wire)):
                return None
            message = f"'{wire.port.name}' cannot follow '{measured.port.name}': {units[0]} is not {units[1]}"
            hint = "follow a value of the same dimension, or correct the units"
            diagnostics.error("unit-mismatch", span, message, hint=hint)
            return None
        factor = conversion_factor(units[0], units[1])
    there, back = _joined(measured.steps), _joined(wire.steps)
    offset = (there.offset * factor - back.offset) / back.scale
    step = ConversionStep(there.scale * factor / back.scale, _double(offset))
    if not is_computable([step]):
        message = f"a double cannot represent the conversion from '{measured.port.name}' to '{wire.port.name}'"
        diagnostics.error("out-of-range", span, message, hint="check 'scale' and 'offset' of both")
        return None
    return step


def _is_refused(wire: Wire, bindings: Bindings) -> bool:
    """True if the unit of this wire itself is an error: then that message says enough."""
    units = dimension_of(wire.unit), dimension_of(_model_unit(wire, bindings))
    unscaled = bindings.inputs[wire.port.name][1].conversion.scale is None
    return bool(wire.unit) and unscaled and (None in units or units[0] != units[1])


def _model_unit(wire: Wire, bindings: Bindings) -> str:
    """The unit of the value of a model input; empty if it is not known."""
    stated = bindings.inputs[wire.port.name][1].conversion.unit
    return normal_unit(wire.port.unit if stated is None else stated)


def _joined(steps: Iterable[ConversionStep]) -> ConversionStep:
    """All steps as one, without their limits."""
    scale: Fraction | float = Fraction(1)
    offset: Fraction | float = Fraction(0)
    for step in steps:
        scale, offset = scale * step.scale, offset * step.scale + _exact(step.offset)
    return ConversionStep(scale, float(offset))


def _with_axis(followed: Followed, components: Mapping[str, Component]) -> Followed:
    """``followed`` with the component that guards its axis, and with the range that this component knows."""
    for guard in components.values():
        axis = guard.kind.axis
        used = guard.uses.get(axis.sensor) if axis is not None else None
        if axis is not None and used is not None and used.component == followed.measured.component.name:
            around = _range(axis, guard, components[used.component])
            step = followed.step
            if around is not None:
                low, high = sorted(_double(angle * step.scale + _exact(step.offset)) for angle in around)
                return replace(followed, guard=guard.name, range=(low, high))
            return replace(followed, guard=guard.name)
    return followed


def _range(axis: KindAxis, guard: Component, sensor: Component) -> tuple[Fraction, Fraction] | None:
    """The values of the sensor that a guarded axis can have: nearer to its zero than the travel of homing."""
    section, _, key = axis.travel.partition(".")
    value: object = guard.parameters.get(section)
    travel = value.get(key) if isinstance(value, Mapping) else None
    zero = sensor.parameters.get(axis.zero) or 0
    if section not in guard.node or not isinstance(travel, (int, float, Fraction)):
        return None
    assert isinstance(zero, (int, float, Fraction))
    return Fraction(zero) - Fraction(travel), Fraction(zero) + Fraction(travel)
