# SPDX-License-Identifier: Apache-2.0
"""Makes wires of bindings: finds the ports of the model and the components, and checks directions, types and units."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
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


class Wiring:
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
                if port.name not in misspelt:  # The error about the misspelt name in the bindings reports it.
                    otherwise = f"add 'inputs: {{{port.name}: ...}}' with one of"
                    hint = _nearest(port.name, lambda: self._possible(direction), otherwise, self.diagnostics)
                    message, about = f"model input '{port.name}' is not bound", f"inputs.{port.name}"
                    self.diagnostics.error("unbound-input", self._section("inputs"), message, hint=hint, about=about)
                continue
            _, binding = bound[port.name]
            end = self._end(binding, direction)
            if end is None:
                continue
            component, component_port = end
            steps = self._steps(port, binding, component, component_port)
            whole = port.type == "integer" and _is_stated(component_port.integer_with, component)
            if component_port.type == "real" and port.type != "real" and not whole:
                given = f"'{component.name}.{component_port.name}' gives any number"
                message = f"{given}, but '{port.name}' needs {port.type} values"
                hint = "make the model's input real"
                wanted = component_port.boolean_with if port.type == "boolean" else component_port.integer_with
                if wanted:
                    stated = ", ".join(f"{key}: {value}" for key, value in wanted.items())
                    hint = f"set '{stated}' in '{component.name}', or {hint}"
                self.diagnostics.error("wrong-port-type", binding.span, message, hint=hint)
            unit = _unit_at(port, binding, component, component_port)
            wires.append(Wire(port, component, component_port, steps, unit, binding.span))
        return tuple(wires)

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
                    hint = f"bind it, or write '{port.name}: unconnected'"
                    message, about = f"model output '{port.name}' is not bound", f"outputs.{port.name}"
                    self.diagnostics.warning(
                        "unbound-output", self._section("outputs"), message, hint=hint, about=about
                    )
                continue
            for binding in bound[port.name][1]:
                end = self._end(binding, direction)
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

    def _section(self, key: str) -> Span:
        root = self.bindings.root
        return root.key_span(key) if key in root else self.bindings.model_span

    def _unknown_ports(
        self,
        what: str,
        bound: Mapping[str, tuple[Span, object]],
        ports: tuple[Port, ...],
        others: tuple[Port, ...],
    ) -> set[str]:
        """Reports names in the bindings that are not ports.  Returns the ports that the user probably means."""
        meant = set()
        names = {port.name for port in ports}
        other_names = {port.name for port in others}
        for name, (span, _) in bound.items():
            if name in names:
                continue
            if name in other_names:
                wrong = "output" if what == "input" else "input"
                message = f"'{name}' is an {wrong} of {self.model.name}"
                self.diagnostics.error("wrong-direction", span, message, hint=f"move it to '{wrong}s'")
                continue
            hint = _nearest(name, lambda: names, f"{what}s of {self.model.name}", self.diagnostics)
            meant |= {port for port in names if hint == f"did you mean '{port}'?"}
            self.diagnostics.error("unknown-port", span, f"{self.model.name} has no {what} '{name}'", hint=hint)
        return meant

    def _possible(self, direction: str) -> list[str]:
        """References to all component ports of a direction, with the short form for main ports."""
        return [
            component.kind.reference(component.name, port)
            for component in self.components.values()
            for port in component.kind.ports
            if port.direction == direction
        ]

    def _end(self, binding: Binding, direction: str) -> tuple[ResolvedComponent, KindPort] | None:
        """The component port that a binding names.

        None after reporting that it does not exist or has another direction.
        """
        component = self.components.get(binding.component)
        if component is None:
            hint = _nearest(binding.component, lambda: self._possible(direction), "possible", self.diagnostics)
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
            possible = sorted(self._possible(direction)) if self.diagnostics.wants_hints else []
            hint = f"possible: {', '.join(possible)}" if possible else ""
            self.diagnostics.error("wrong-direction", binding.span, message, hint=hint)
            return None
        return component, port

    def _steps(self, port: Port, binding: Binding, component: Component, component_port: KindPort) -> tuple[Step, ...]:
        """The steps of a wire: the conversion of the component, of the units, and of the wire itself.

        They run in this order towards an input of the model, and in the opposite order from an output.
        """
        own: list[Step] = []
        unit = normal_unit(component_port.unit)
        if not self.plant:
            own, unit = component_steps(component, component_port)
        stated = normal_unit(binding.conversion.unit if binding.conversion.unit is not None else port.unit)
        of_wire = _stated_step(binding.conversion, f"{port.direction}s.{port.name}")
        if port.direction == "input":
            between = self._unit_step(unit, stated, binding, f"{component.name} -> {port.name}")
            steps = [*own, *between, *of_wire]
        else:
            between = self._unit_step(stated, unit, binding, f"{port.name} -> {component.name}")
            # Towards the hardware, a unit conversion of the component runs in the opposite direction.
            of_units = [Step(1 / s.scale, reason=_reversed(s.reason)) for s in own if " -> " in s.reason]
            steps = [*of_wire, *between, *(step for step in own if " -> " not in step.reason), *of_units]
        if not is_computable(steps):
            message = "the conversion of this wire has a factor or an offset that a double cannot represent"
            hint = "check 'scale' and 'offset' of the wire and of the component"
            self.diagnostics.error("out-of-range", binding.span, message, hint=hint)
        return tuple(steps)

    def _unit_step(self, source: str, target: str, binding: Binding, names: str) -> list[Step]:
        """The step that converts one unit to another; none if the wire has a scale, or if a unit is not known.

        Reports units that do not convert to each other.
        """
        if binding.conversion.scale is not None or not source or not target or source == target:
            return []
        if dimension_of(source) is None or dimension_of(target) is None or dimension_of(source) != dimension_of(target):
            message = f"{names}: {source} cannot be converted to {target}"
            hint = "set 'scale' in the binding, or correct the unit"
            self.diagnostics.error("unit-mismatch", binding.span, message, hint=hint)
            return []
        return [Step(scale=conversion_factor(source, target), reason=f"{source} -> {target}")]


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
    steps += _stated_step(conversion, f"components.{component.name}")
    return steps, given or ("" if conversion.scale is not None else unit)


def is_share_with_unit(unit: str, component: Component, port: KindPort) -> bool:
    """True if a value with a unit is given to a port that takes a share, from -1 to 1, without a conversion."""
    return port.drive and bool(normal_unit(unit)) and not component_steps(component, port)[0]


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


def _nearest(word: str, choices: Callable[[], Iterable[str]], otherwise: str, diagnostics: Diagnostics) -> str:
    return did_you_mean(word, choices(), otherwise) if diagnostics.wants_hints else ""


def _stated_step(conversion: Conversion, reason: str) -> list[Step]:
    """The step with the scale, the offset and the limits that a wire or a component states; none without them."""
    if conversion.scale is None and conversion.offset is None and conversion.limits is None:
        return []
    return [Step(conversion.scale or Fraction(1), conversion.offset or 0.0, conversion.limits, reason)]


def _reversed(reason: str) -> str:
    source, _, target = reason.partition(" -> ")
    return f"{target} -> {source}"
