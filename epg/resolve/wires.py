# SPDX-License-Identifier: Apache-2.0
"""Makes wires of bindings: finds the ports of the model and the components, and checks directions, types and units."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from fractions import Fraction

from epg.catalog.catalog import KindPort
from epg.check.bindings import Binding, Bindings, Conversion
from epg.check.configuration import Component
from epg.diagnostics import Diagnostics, Note, did_you_mean
from epg.models.model import Model, Port
from epg.quantity import conversion_factor, dimension_of, normal_unit
from epg.resolve.application import ResolvedComponent, Step, Wire
from epg.resolve.conversion import is_computable
from epg.source import Span


def input_wires(
    bindings: Bindings,
    model: Model,
    components: Mapping[str, Component],
    resolved: Mapping[str, ResolvedComponent],
    diagnostics: Diagnostics,
    *,
    direction: str = "source",
) -> tuple[Wire, ...]:
    """The wires into ``model``.  Each input must have exactly one.

    ``direction`` is "source" for a controller, whose inputs read sensors, and "sink" for a plant, whose inputs read
    actuators.  Conversions of components are between driver and controller, so they do not apply to wires of a plant.
    """
    wires: list[Wire] = []
    misspelt = _unknown_ports(bindings.inputs, model.inputs, model.outputs, model, "input", diagnostics)
    for port in model.inputs:
        if port.name not in bindings.inputs:
            if port.name in misspelt:
                continue  # The error about the misspelt name in the bindings reports it.
            otherwise = f"add 'inputs: {{{port.name}: ...}}' with one of"
            hint = _nearest(port.name, lambda: _possible(components.values(), direction), otherwise, diagnostics)
            span = bindings.root.key_span("inputs") if "inputs" in bindings.root else bindings.model_span
            diagnostics.error(
                "unbound-input", span, f"model input '{port.name}' is not bound", hint=hint, about=f"inputs.{port.name}"
            )
            continue
        _, binding = bindings.inputs[port.name]
        end = _end(binding, direction, components, diagnostics)
        if end is None:
            continue
        component, component_port = end
        steps = _input_steps(port, binding, component, component_port, diagnostics, physical=direction == "sink")
        _check_range(steps, binding, diagnostics)
        whole = port.type == "integer" and _is_stated(component_port.integer_with, component)
        if component_port.type == "real" and port.type != "real" and not whole:
            message = (
                f"'{component.name}.{component_port.name}' gives any number, but '{port.name}' needs {port.type} values"
            )
            hint = "make the model's input real"
            wanted = component_port.boolean_with if port.type == "boolean" else component_port.integer_with
            if wanted:
                stated = ", ".join(f"{key}: {value}" for key, value in wanted.items())
                hint = f"set '{stated}' in '{component.name}', or {hint}"
            diagnostics.error("wrong-port-type", binding.span, message, hint=hint)
        wires.append(Wire(port, resolved[component.name], component_port, steps, binding.span))
    return tuple(wires)


def _is_stated(values: Mapping[str, str], component: Component) -> bool:
    return bool(values) and all(component.parameters[key] == value for key, value in values.items())


def output_wires(
    bindings: Bindings,
    model: Model,
    components: Mapping[str, Component],
    resolved: Mapping[str, ResolvedComponent],
    diagnostics: Diagnostics,
    *,
    direction: str = "sink",
) -> tuple[Wire, ...]:
    """The wires out of ``model``.  A component port must not be driven twice.

    ``direction`` is "sink" for a controller, whose outputs drive actuators, and "source" for a plant, whose outputs
    drive sensors.
    """
    wires: list[Wire] = []
    drivers: dict[tuple[str, str], tuple[str, Span]] = {}
    misspelt = _unknown_ports(bindings.outputs, model.outputs, model.inputs, model, "output", diagnostics)
    for port in model.outputs:
        if port.name not in bindings.outputs:
            if port.name in misspelt:
                continue
            span = bindings.root.key_span("outputs") if "outputs" in bindings.root else bindings.model_span
            hint = f"bind it, or write '{port.name}: unconnected'"
            diagnostics.warning(
                "unbound-output",
                span,
                f"model output '{port.name}' is not bound",
                hint=hint,
                about=f"outputs.{port.name}",
            )
            continue
        for binding in bindings.outputs[port.name][1]:
            end = _end(binding, direction, components, diagnostics)
            if end is None:
                continue
            component, component_port = end
            first = drivers.setdefault((component.name, component_port.name), (port.name, binding.span))
            if first[1] != binding.span:
                message = f"'{component.name}.{component_port.name}' is already driven by '{first[0]}'"
                notes = [Note("bound here", first[1])]
                diagnostics.error("bound-twice", binding.span, message, hint="remove one of the two", notes=notes)
            steps = _output_steps(port, binding, component, component_port, diagnostics, physical=direction == "source")
            _check_range(steps, binding, diagnostics)
            wires.append(Wire(port, resolved[component.name], component_port, steps, binding.span))
    return tuple(wires)


def _unknown_ports(
    bound: Iterable[str] | Mapping[str, tuple[Span, object]],
    ports: tuple[Port, ...],
    others: tuple[Port, ...],
    model: Model,
    what: str,
    diagnostics: Diagnostics,
) -> set[str]:
    """Reports names in the bindings that are not ports.  Returns the ports that the user probably means."""
    assert isinstance(bound, Mapping)
    meant = set()
    names = {port.name for port in ports}
    other_names = {port.name for port in others}
    for name, (span, _) in bound.items():
        if name in names:
            continue
        if name in other_names:
            wrong = "output" if what == "input" else "input"
            diagnostics.error(
                "wrong-direction", span, f"'{name}' is an {wrong} of {model.name}", hint=f"move it to '{wrong}s'"
            )
            continue
        hint = _nearest(name, lambda: names, f"{what}s of {model.name}", diagnostics)
        meant |= {port for port in names if hint == f"did you mean '{port}'?"}
        diagnostics.error("unknown-port", span, f"{model.name} has no {what} '{name}'", hint=hint)
    return meant


def _nearest(word: str, choices: Callable[[], Iterable[str]], otherwise: str, diagnostics: Diagnostics) -> str:
    return did_you_mean(word, choices(), otherwise) if diagnostics.wants_hints else ""


def _possible(components: Iterable[Component], direction: str) -> list[str]:
    """References to all component ports of a direction, with the short form for main ports."""
    result = []
    for component in components:
        main = component.kind.main_port(direction)
        for port in component.kind.ports:
            if port.direction == direction:
                result.append(component.name if port is main else f"{component.name}.{port.name}")
    return result


def _end(
    binding: Binding, direction: str, components: Mapping[str, Component], diagnostics: Diagnostics
) -> tuple[Component, KindPort] | None:
    """The component port that a binding names; None after reporting that it does not exist or has another direction."""
    component = components.get(binding.component)
    if component is None:
        hint = _nearest(binding.component, lambda: _possible(components.values(), direction), "possible", diagnostics)
        diagnostics.error("unknown-component", binding.span, f"there is no component '{binding.component}'", hint=hint)
        return None
    ports = {port.name: port for port in component.kind.ports}
    if binding.port is None:
        default = component.kind.main_port(direction)
        if default is None:
            _wrong_direction(component, component.name, direction, components, binding, diagnostics)
            return None
        return component, default
    if binding.port not in ports:
        message = f"a {component.kind.name} has no port '{binding.port}'"
        hint = did_you_mean(binding.port, ports, "ports")
        diagnostics.error("unknown-port", binding.span, message, hint=hint)
        return None
    if ports[binding.port].direction != direction:
        _wrong_direction(component, f"{component.name}.{binding.port}", direction, components, binding, diagnostics)
        return None
    return component, ports[binding.port]


def _wrong_direction(
    component: Component,
    reference: str,
    direction: str,
    components: Mapping[str, Component],
    binding: Binding,
    diagnostics: Diagnostics,
) -> None:
    verb = "does not give a value" if direction == "source" else "does not accept a value"
    message = f"'{reference}' ({component.kind.name}) {verb}"
    possible = sorted(_possible(components.values(), direction)) if diagnostics.wants_hints else []
    hint = f"possible: {', '.join(possible)}" if possible else ""
    diagnostics.error("wrong-direction", binding.span, message, hint=hint)


def component_steps(component: Component, port: KindPort) -> tuple[list[Step], str]:
    """The conversion that the component itself states, and the unit on its model side (empty: unknown)."""
    conversion = component.conversion
    unit = normal_unit(port.unit)
    steps: list[Step] = []
    if not port.default and port.type == "boolean":
        return steps, unit  # The conversion of a component applies to its main value, not to boolean ports beside it.
    given = normal_unit(conversion.unit) if conversion.unit is not None else ""
    if conversion.scale is None and given and unit and given != unit and dimension_of(given) == dimension_of(unit):
        steps.append(Step(scale=conversion_factor(unit, given), reason=f"{unit} -> {given}"))
    if conversion.scale is not None or conversion.offset is not None or conversion.limits is not None:
        steps.append(_step(conversion, f"components.{component.name}"))
    return steps, given or ("" if conversion.scale is not None else unit)


def _step(conversion: Conversion, reason: str) -> Step:
    return Step(conversion.scale or Fraction(1), conversion.offset or 0.0, conversion.limits, reason)


def _unit_step(source: str, target: str, binding: Binding, names: str, diagnostics: Diagnostics) -> list[Step]:
    """The step that converts one unit to another; none if the wire has a scale, or if a unit is not known.

    Reports units that do not convert to each other.
    """
    if binding.conversion.scale is not None or not source or not target or source == target:
        return []
    if dimension_of(source) is None or dimension_of(target) is None or dimension_of(source) != dimension_of(target):
        diagnostics.error(
            "unit-mismatch",
            binding.span,
            f"{names}: {source} cannot be converted to {target}",
            hint="set 'scale' in the binding, or correct the unit",
        )
        return []
    return [Step(scale=conversion_factor(source, target), reason=f"{source} -> {target}")]


def _input_steps(
    port: Port,
    binding: Binding,
    component: Component,
    component_port: KindPort,
    diagnostics: Diagnostics,
    *,
    physical: bool,
) -> tuple[Step, ...]:
    """The steps from a component to an input: the component's conversion, the units, the conversion of the wire.

    With ``physical``, for a plant, the conversion of the component does not apply.
    """
    steps, unit = ([], normal_unit(component_port.unit)) if physical else component_steps(component, component_port)
    wanted = normal_unit(binding.conversion.unit if binding.conversion.unit is not None else port.unit)
    steps += _unit_step(unit, wanted, binding, f"{component.name} -> {port.name}", diagnostics)
    steps += _wire_step(binding, f"inputs.{port.name}")
    return tuple(steps)


def _output_steps(
    port: Port,
    binding: Binding,
    component: Component,
    component_port: KindPort,
    diagnostics: Diagnostics,
    *,
    physical: bool,
) -> tuple[Step, ...]:
    """The steps from an output to a component: the conversion of the wire, the units, the component's conversion.

    With ``physical``, for a plant, the conversion of the component does not apply.
    """
    own, unit = ([], normal_unit(component_port.unit)) if physical else component_steps(component, component_port)
    given = normal_unit(binding.conversion.unit if binding.conversion.unit is not None else port.unit)
    between = _unit_step(given, unit, binding, f"{port.name} -> {component.name}", diagnostics)
    # Towards the hardware, a unit conversion of the component runs in the opposite direction.
    own = [Step(1 / step.scale, reason=_reversed(step.reason)) if " -> " in step.reason else step for step in own]
    ordered = [step for step in own if " -> " not in step.reason] + [step for step in own if " -> " in step.reason]
    return (*_wire_step(binding, f"outputs.{port.name}"), *between, *ordered)


def _check_range(steps: Sequence[Step], binding: Binding, diagnostics: Diagnostics) -> None:
    if not is_computable(steps):
        message = "the conversion of this wire has a factor or an offset that a double cannot represent"
        hint = "check 'scale' and 'offset' of the wire and of the component"
        diagnostics.error("out-of-range", binding.span, message, hint=hint)


def _wire_step(binding: Binding, reason: str) -> list[Step]:
    conversion = binding.conversion
    if conversion.scale is None and conversion.offset is None and conversion.limits is None:
        return []
    return [_step(conversion, reason)]


def _reversed(reason: str) -> str:
    source, _, target = reason.partition(" -> ")
    return f"{target} -> {source}"
