# SPDX-License-Identifier: Apache-2.0
"""Makes wires of bindings: finds the ports of the model and the components, and checks directions, types and units."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from functools import cached_property

from epg.generator.catalog.catalog import KindPort
from epg.generator.check.bindings import UNCONNECTED, Binding, Bindings
from epg.generator.check.configuration import Component
from epg.generator.correction import Choice, KeyValue, correction
from epg.generator.diagnostics import Diagnostics, Note, did_you_mean, nearest, question
from epg.generator.models.model import Model, Port
from epg.generator.quantity import UNITS, conversion_factor, dimension_of, meant_unit, normal_unit
from epg.generator.resolve.application import ConversionStep, ResolvedComponent, Wire
from epg.generator.resolve.conversion import is_computable
from epg.generator.resolve.fitting import component_steps, is_share_with_unit, stated_step
from epg.generator.resolve.matching import Match, match_ports
from epg.generator.resolve.parameters import report_inexact_limits
from epg.generator.source import Span

_LISTED = 24
"""The number of component ports that a hint lists."""


class WireBuilder:
    """Makes the wires of one model: of a controller, or of a ``plant``.

    The inputs of a controller read sensors, and its outputs drive actuators.  The inputs of a plant read actuators, and
    its outputs drive sensors.  Conversions of components are between driver and controller, so they do not apply to
    wires of a plant.
    """

    def __init__(
        self,
        bindings: Bindings,
        model: Model,
        components: Mapping[str, ResolvedComponent],
        diagnostics: Diagnostics,
        *,
        plant: bool = False,
    ) -> None:
        self.bindings = bindings
        self.model = model
        self.components = components
        self.diagnostics = diagnostics
        self.plant = plant

    def inputs(self) -> tuple[Wire, ...]:
        """The wires into the model.  Each input must have exactly one."""
        direction = "sink" if self.plant else "source"
        bound = self.bindings.inputs
        wires: list[Wire] = []
        misspelt = self._unknown_ports("input", bound, self.model.inputs, self.model.outputs)
        for port in self.model.inputs:
            if port.name not in bound:
                if port.name not in misspelt:
                    self._report_unbound(port)
                continue
            _, binding = bound[port.name]
            end = self._end(port, binding, direction)
            if end is None:
                continue
            component, component_port = end
            steps = self._steps(port, binding, component, component_port)
            self._check_type(port, binding.span, component, component_port)
            unit = _unit_at(port, binding, component, component_port)
            wires.append(Wire(port, component, component_port, steps, unit, binding.span))
        return tuple(wires)

    def _check_type(self, port: Port, span: Span, component: ResolvedComponent, component_port: KindPort) -> None:
        """Reports a component port that gives any number to an input that needs whole numbers or booleans."""
        whole = port.type == "integer" and _is_stated(component_port.integer_with, component)
        if component_port.type != "real" or port.type == "real" or whole:
            return
        given = f"'{component.name}.{component_port.name}' gives any number"
        message = f"{given}, but '{port.name}' needs {port.type} values"
        hint = "make the model's input real"
        wanted = component_port.boolean_with if port.type == "boolean" else component_port.integer_with
        if wanted:
            stated = ", ".join(f"{key}: {value}" for key, value in wanted.items())
            hint = f"set '{stated}' in '{component.name}', or {hint}"
        self.diagnostics.error("wrong-port-type", span, message, hint=hint)

    def outputs(self) -> tuple[Wire, ...]:
        """The wires out of the model.  A component port must not be driven twice."""
        direction = "source" if self.plant else "sink"
        bound = self.bindings.outputs
        wires: list[Wire] = []
        drivers: dict[tuple[str, str], tuple[str, Span]] = {}
        misspelt = self._unknown_ports("output", bound, self.model.outputs, self.model.inputs)
        for port in self.model.outputs:
            if port.name not in bound:
                if port.name not in misspelt:
                    self._report_unbound(port)
                continue
            for binding in bound[port.name][1]:
                end = self._end(port, binding, direction)
                if end is None:
                    continue
                component, component_port = end
                first = drivers.setdefault((component.name, component_port.name), (port.name, binding.span))
                if first[1] != binding.span:
                    message = f"'{component.name}.{component_port.name}' is already driven by '{first[0]}'"
                    notes, hint = [Note("bound here", first[1])], "remove one of the two"
                    self.diagnostics.error("bound-twice", binding.span, message, hint=hint, notes=notes)
                steps = self._steps(port, binding, component, component_port)
                self._check_share(port, binding, component, component_port)
                unit = _unit_at(port, binding, component, component_port)
                wires.append(Wire(port, component, component_port, steps, unit, binding.span))
        return tuple(wires)

    def _check_share(self, port: Port, binding: Binding, component: Component, component_port: KindPort) -> None:
        """Warns of a value with a unit, such as an angle or a voltage, that becomes the duty of a motor as it is."""
        unit = binding.conversion.unit if binding.conversion.unit is not None else port.unit
        if binding.conversion.scale is not None or not is_share_with_unit(unit, component, component_port):
            return
        message = (
            f"'{component.name}.{component_port.name}' is a share of the supply voltage from -1 to 1, "
            f"but '{port.name}' has the unit {normal_unit(unit)}"
        )
        hint = "set 'scale' in the binding, bind another port, or correct the unit of the model's port"
        self.diagnostics.warning("unit-of-duty", binding.span, message, hint=hint)

    def _report_unbound(self, port: Port) -> None:
        """Reports an input, or warns of an output.  If its name is misspelt in the bindings, that error is enough."""
        root, key = self.bindings.root, f"{port.direction}s"
        span = root.key_span(key) if key in root else self.bindings.model_span
        hint = self._binding_hint(port) if self.diagnostics.wants_hints else ""
        message, about = f"model {port.direction} '{port.name}' is not bound", f"{key}.{port.name}"
        if port.direction == "input":
            self.diagnostics.error("unbound-input", span, message, hint=hint, about=about)
        else:
            self.diagnostics.warning("unbound-output", span, message, hint=hint, about=about)

    def _unknown_ports(
        self,
        what: str,
        bound: Mapping[str, tuple[Span, object]],
        ports: tuple[Port, ...],
        others: tuple[Port, ...],
    ) -> set[str]:
        """Reports names in the bindings that are not ports.  Returns the ports that the user probably means."""
        meant: set[str] = set()
        names = {port.name for port in ports}
        left = names - bound.keys()  # A port that the bindings name already is not meant.
        asked = {str(correction("", name)): name for name in left}
        other_names = {port.name for port in others}
        for name, (span, _) in bound.items():
            if name in names:
                continue
            if name in other_names:
                wrong = "output" if what == "input" else "input"
                message = f"'{name}' is an {wrong} of {self.model.name}"
                self.diagnostics.error("wrong-direction", span, message, hint=f"move it to '{wrong}s'")
                continue
            otherwise = f"{what}s of {self.model.name}"
            hint = did_you_mean(name, left, otherwise) if self.diagnostics.wants_hints else ""
            if not left:
                hint = f"remove it: all {what}s of {self.model.name} are in the bindings" if names else ""
            meant |= {asked[hint]} if hint in asked else set()
            self.diagnostics.error("unknown-port", span, f"{self.model.name} has no {what} '{name}'", hint=hint)
        return meant

    @cached_property
    def _matches(self) -> Mapping[str, Match]:
        """The component ports that names, types and units propose for the ports of the model that are not bound."""
        inputs = {name: (_reference(binding),) for name, (_, binding) in self.bindings.inputs.items()}
        outputs = {name: tuple(map(_reference, ends)) for name, (_, ends) in self.bindings.outputs.items()}
        return match_ports(self.model, self.components, {**inputs, **outputs}, plant=self.plant)

    def _binding_hint(self, port: Port) -> str:
        """What to write for a port that is not bound.

        A match of an output that is only a guess can move a motor: the user must choose it.
        """
        match = self._matches[port.name]
        if port.direction == "output":
            left = self._wire(port, UNCONNECTED)
            if not match.proposal:
                return f"bind it, or {left}"
            wire = self._wire(port, match.proposal)
            return Choice(f"{wire}, or {left}", wire, *(() if match.reference else (left,)))
        if match.proposal:
            return self._wire(port, match.proposal, f"add 'inputs: {{{port.name}: {match.proposal}}}'")
        if match.fitting:
            return f"add 'inputs: {{{port.name}: ...}}' with one of: {_listed(match.fitting)}"
        if match.candidates:
            return (
                f"no component that fits '{port.name}' is free: describe one in the .tcf, then bind '{port.name}' to it"
            )
        return f"describe a component for '{port.name}' in the .tcf, then bind '{port.name}' to it"

    def wire_to(self, reference: str, outputs: Sequence[Wire]) -> str | None:
        """How to drive a component port to which none of the ``outputs`` leads; None if no output is free for it.

        The hint proposes the output that is meant by its name, as long as the bindings of all others are right.
        """
        bound = {name: tuple(map(_reference, ends)) for name, (_, ends) in self.bindings.outputs.items() if ends}
        free = [port for port in self.model.outputs if port.name not in bound]
        complete = sum(map(len, bound.values())) == len(outputs)
        if complete and not free:
            return None
        matches = match_ports(self.model, self.components, bound) if complete else {}
        meant = [port for port in free if complete and matches[port.name].proposal == reference]
        return self._wire(meant[0], reference) if meant else "bind a model output to it"

    def _wire(self, port: Port, reference: str, sentence: str = "") -> KeyValue:
        """The hint to bind ``port`` to a component port, or to leave it unconnected."""
        section, ports = ("inputs", self.model.inputs) if port.direction == "input" else ("outputs", self.model.outputs)
        sentence = sentence or f"write '{port.name}: {reference}'"
        order = [each.name for each in ports]
        return KeyValue(sentence, self.bindings.root.span.file, (section, port.name), reference, order)

    def _component_hint(self, port: Port, written: str) -> str:
        """The component that is meant by a name that does not exist: of those that are for this, the one nearest to it.

        If none is near, the hint lists all that fit.
        """
        match = self._matches[port.name]
        free, near = match.meant or match.fitting, nearest(written, match.candidates)
        meant = nearest(written, free)
        if meant and (set(meant) & set(near) or not near):
            return question(meant, written)
        possible = self._possible(port)
        if near and near[0] not in possible:
            listed = f"; free: {_listed(free)}" if free else ""
            if self._is_used(near[0], port):
                return f"another port uses '{near[0]}'{listed}"
            return f"'{near[0]}' does not fit '{port.name}'{listed}"
        return f"possible: {_listed(possible)}" if possible else ""

    def _is_used(self, reference: str, port: Port) -> bool:
        """True if the bindings name a component port for another port of the model than ``port``."""
        bound: dict[str, Sequence[Binding]] = {name: (end,) for name, (_, end) in self.bindings.inputs.items()}
        if port.direction == "output":
            bound = {name: ends for name, (_, ends) in self.bindings.outputs.items()}
        ends = [end for name, listed in bound.items() if name != port.name for end in listed]
        return any(reference in (_reference(end), end.component) for end in ends)

    def _possible(self, port: Port) -> tuple[str, ...]:
        """The component ports to which ``port`` can be bound, the best first: the free ones, if there are any."""
        match = self._matches[port.name]
        return match.fitting or match.candidates

    def _end(self, model_port: Port, binding: Binding, direction: str) -> tuple[ResolvedComponent, KindPort] | None:
        """The component port that a binding names.

        None after reporting that it does not exist or has another direction.
        """
        component = self.components.get(binding.component)
        if component is None:
            hint = self._component_hint(model_port, _reference(binding)) if self.diagnostics.wants_hints else ""
            message = f"there is no component '{binding.component}'"
            self.diagnostics.error("unknown-component", binding.span, message, hint=hint)
            return None
        port, reference = component.kind.main_port(direction), component.name
        if binding.port is not None:
            ports = {port.name: port for port in component.kind.ports}
            if binding.port not in ports:
                message = f"a {component.kind.name} has no port '{binding.port}'"
                hint = did_you_mean(binding.port, ports, "ports")
                self.diagnostics.error("unknown-port", binding.span, message, hint=hint)
                return None
            port, reference = ports[binding.port], f"{component.name}.{binding.port}"
        if port is None or port.direction != direction:
            verb = "does not give a value" if direction == "source" else "does not accept a value"
            message = f"'{reference}' ({component.kind.name}) {verb}"
            possible = self._possible(model_port) if self.diagnostics.wants_hints else ()
            hint = f"possible: {_listed(possible)}" if possible else ""
            self.diagnostics.error("wrong-direction", binding.span, message, hint=hint)
            return None
        return component, port

    def _steps(
        self, port: Port, binding: Binding, component: Component, component_port: KindPort
    ) -> tuple[ConversionStep, ...]:
        """The steps of a wire: the conversion of the component, of the units, and of the wire itself.

        They run in this order towards an input of the model, and in the opposite order from an output.
        """
        own: list[ConversionStep] = []
        unit = normal_unit(component_port.unit)
        if not self.plant:
            own, unit = component_steps(component, component_port)
        stated = normal_unit(binding.conversion.unit if binding.conversion.unit is not None else port.unit)
        self._check_scale(unit, normal_unit(component_port.unit), port, binding, component)
        of_wire = stated_step(binding.conversion, f"{port.direction}s.{port.name}")
        if port.direction == "input":
            between = self._unit_step(unit, stated, binding, port, component)
            steps = [*own, *between, *of_wire]
        else:
            between = self._unit_step(stated, unit, binding, port, component)
            # Towards the hardware, a unit conversion of the component runs in the opposite direction.
            of_units = [ConversionStep(1 / s.scale, reason=_reversed(s.reason)) for s in own if " -> " in s.reason]
            steps = [*of_wire, *between, *(step for step in own if " -> " not in step.reason), *of_units]
        if not is_computable(steps):
            message = "the conversion of this wire has a factor or an offset that a double cannot represent"
            hint = "check 'scale' and 'offset' of the wire and of the component"
            self.diagnostics.error("out-of-range", binding.span, message, hint=hint)
        self._check_whole_limits(port, binding)
        return tuple(steps)

    def _check_scale(self, unit: str, own: str, port: Port, binding: Binding, component: Component) -> None:
        """Warns of a scale without a unit that leads from one unit to another.

        ``own`` is the unit of the component's port, and ``unit`` that after the component's conversion.
        """
        there = normal_unit(port.unit)
        if binding.conversion.unit is not None or not there:
            return
        if binding.conversion.scale is not None:
            owner, conversion, here = f"the binding of '{port.name}'", binding.conversion, unit
        elif component.conversion.scale is not None and component.conversion.unit is None and not self.plant:
            owner, conversion, here = f"'{component.name}'", component.conversion, own
        else:
            return
        if not here or here == there or conversion.scale == 1:  # 1: the number is used as it is (docs/files.md)
            return
        ends = (here, there) if port.direction == "input" else (there, here)
        message = f"'scale' in {owner} has no unit, and leads from {ends[0]} to {ends[1]}"
        hint = f"if the value of '{port.name}' is in {there}, write 'unit: {there}' in {owner}"
        self.diagnostics.warning("scale-without-unit", conversion.span or binding.span, message, hint=hint)

    def _check_whole_limits(self, port: Port, binding: Binding) -> None:
        """Reports limits of whole numbers that are so large that doubles do not have all whole numbers."""
        conversion = binding.conversion
        scaled = conversion.scale is not None or conversion.offset is not None
        if conversion.limits is None or not (port.whole or port.type == "integer"):
            return
        if port.direction == "output" and scaled:
            return  # the limits of the converted value
        report_inexact_limits(port.name, conversion.limits, conversion.span or binding.span, self.diagnostics)

    def _unit_step(
        self, source: str, target: str, binding: Binding, port: Port, component: Component
    ) -> list[ConversionStep]:
        """The step that converts one unit to another; none if the wire has a scale, or if a unit is not known.

        Reports units that do not convert to each other.
        """
        if binding.conversion.scale is not None or not source or not target or source == target:
            return []
        if dimension_of(source) is None or dimension_of(target) is None or dimension_of(source) != dimension_of(target):
            names = (component.name, port.name) if port.direction == "input" else (port.name, component.name)
            message = f"{' -> '.join(names)}: {source} cannot be converted to {target}"
            known = {dimension_of(unit) for unit in (source, target)} - {None}
            hint = (
                _unit_hint(self.bindings, binding, port, component, known)
                or "set 'scale' in the binding, or correct the unit"
            )
            self.diagnostics.error("unit-mismatch", binding.span, message, hint=hint)
            return []
        return [ConversionStep(scale=conversion_factor(source, target), reason=f"{source} -> {target}")]


def _unit_at(port: Port, binding: Binding, component: Component, component_port: KindPort) -> str:
    """The unit of a value at the component: the component's own one, else that of the model's port.

    Empty if neither is known, or if a scale without units is between them.
    """
    own = normal_unit(component_port.unit) or component_steps(component, component_port)[1]
    if own or component.conversion.scale is not None or binding.conversion.scale is not None:
        return own
    return normal_unit(binding.conversion.unit if binding.conversion.unit is not None else port.unit)


def _is_stated(values: Mapping[str, str], component: Component) -> bool:
    return bool(values) and all(component.parameters[key] == value for key, value in values.items())


def _unit_hint(
    bindings: Bindings, binding: Binding, port: Port, component: Component, known: Collection[str | None]
) -> str:
    """How to write the first unit of a wire that EPG does not know; "" without such a unit, or if its meaning is open.

    ``known`` are the dimensions of the units that EPG knows: the other one must be of the same.
    """
    key = "from" if port.direction == "input" else "to"
    in_bindings = f"write '{port.name}: {{{key}: {_reference(binding)}, unit: {{}}}}' in the bindings"
    for unit, how in (
        (component.conversion.unit, f"write 'unit: {{}}' in '{component.name}'"),
        (binding.conversion.unit, "write 'unit: {}' in the binding"),
        (port.unit if binding.conversion.unit is None else None, in_bindings),
    ):
        if unit is not None and dimension_of(unit) is None:
            meant = meant_unit(unit, UNITS)
            fitting = meant and (not known or dimension_of(meant) in known)
            if not meant or not fitting:
                return ""
            hint = f"'{unit}' is not a unit of EPG: {how.replace('{}', meant)}"
            return hint if how != in_bindings else _with_unit(hint, bindings, port, key, meant)
    return ""


def _with_unit(hint: str, bindings: Bindings, port: Port, key: str, unit: str) -> str:
    """``hint``, which proposes ``unit`` for the only wire of ``port``; its component is written at ``key``."""
    path, file = (f"{port.direction}s", port.name), bindings.root.span.file
    written = bindings.root.get(*path)
    if written is None or written.is_sequence:
        return hint
    if written.is_mapping:
        return KeyValue(hint, file, (*path, "unit"), unit)
    return KeyValue(hint, file, path, {key: written.value, "unit": unit})


def _reference(binding: Binding) -> str:
    return binding.component if binding.port is None else f"{binding.component}.{binding.port}"


def _listed(references: tuple[str, ...]) -> str:
    return ", ".join(references[:_LISTED]) + (", ..." if len(references) > _LISTED else "")


def _reversed(reason: str) -> str:
    source, _, target = reason.partition(" -> ")
    return f"{target} -> {source}"
