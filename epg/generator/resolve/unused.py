# SPDX-License-Identifier: Apache-2.0
"""Warns of components that nothing uses: motors that no output drives, inputs that could stop the robot, and others."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence

from epg.generator.catalog.kind import Kind
from epg.generator.check.bindings import Bindings
from epg.generator.check.configuration import Component, Configuration
from epg.generator.check.fail_safe import can_disable
from epg.generator.correction import KeyValue
from epg.generator.diagnostics import Diagnostics
from epg.generator.models.model import Model
from epg.generator.resolve.application import Plant, Wire
from epg.generator.resolve.matching import match_ports, words_of


def report_unused(
    configuration: Configuration,
    model: Model,
    bindings: Bindings,
    wires: Sequence[Wire],
    plant: Plant | None,
    diagnostics: Diagnostics,
    *,
    complete: bool,
) -> None:
    """Warns of the components to which no wire leads, and that nothing else uses.

    ``complete`` is False if the files have errors: then wires can be missing.
    """
    components = configuration.components
    ends = [*wires, *(() if plant is None else (*plant.inputs, *plant.outputs))]
    used = used_components(configuration, {wire.component.name for wire in ends})
    _report_motors(components, model, bindings, wires, used, diagnostics, complete)
    for component in components.values():
        usable = component.kind.ports or component.kind.transport
        if complete and usable and component.name not in used and not is_motor(component.kind):
            _report(component, configuration, diagnostics)


def _report_motors(
    components: Mapping[str, Component],
    model: Model,
    bindings: Bindings,
    wires: Sequence[Wire],
    used: Collection[str],
    diagnostics: Diagnostics,
    complete: bool,
) -> None:
    """Warns of motors that no output drives, if all outputs are bound without an error or the files have none.

    A robot that is simulated keeps all of its motors.  One that only the plant uses is reported if an output is
    probably meant for it, or if nothing drives any motor.
    """
    outputs = [wire for wire in wires if wire.port.direction == "output"]
    if not complete and not _all_bound(outputs, model, bindings):
        return
    driven = {wire.component.name for wire in outputs}
    motors = {name: component for name, component in components.items() if is_motor(component.kind)}
    still = {name: component for name, component in motors.items() if name not in driven}
    if not still:
        return
    proposals = _driver_proposals(motors, model, bindings, components)
    for name, motor in still.items():
        is_kept = name in used and len(still) < len(motors)
        hint = _motor_hint(name, proposals, bindings, is_kept)
        if hint is not None:
            message = f"no output of the model drives '{name}': it stays in its safe state"
            diagnostics.warning("motor-not-driven", motor.span, message, hint=hint)


def _motor_hint(name: str, proposals: Mapping[str, tuple[str, str]], bindings: Bindings, is_kept: bool) -> str | None:
    """The hint about a motor that no output drives; None if it needs no warning.

    The output that is meant for it may not be bound, which is reported there.
    """
    if name in proposals:
        port, end = proposals[name]
        return _instead(port, end, bindings) if port in bindings.outputs else None
    if is_kept:
        return None
    return f"bind an output of the model to it; an output can drive several: '[{name}, ...]'"


def _all_bound(outputs: Sequence[Wire], model: Model, bindings: Bindings) -> bool:
    """True if the bindings name all outputs of the model, and no end of ``outputs`` is missing or there twice."""
    named = {port.name for port in model.outputs} == bindings.outputs.keys()
    ends = {(wire.component.name, wire.component_port.name) for wire in outputs}
    return named and len(ends) == sum(len(bound) for _, bound in bindings.outputs.values())


def is_motor(kind: Kind) -> bool:
    """True if a number that the model computes drives hardware by a component of ``kind``."""
    return any(port.actuator and port.type == "real" for port in kind.ports)


def can_stop(component: Component, components: Mapping[str, Component]) -> bool:
    """True for an input that could be the emergency stop of a robot: EPG never proposes to remove it."""
    actuated = any(port.actuator for other in components.values() for port in other.kind.ports)
    return actuated and can_disable(component.kind)


def used_components(configuration: Configuration, ends: Collection[str]) -> set[str]:
    """The components that are used: those at the ``ends`` of wires, and those through which the target communicates.

    So are the input that disables the target, and the components that a used component names.  A component without
    ports, such as a guard, is used as long as the first component that it names is: its motor.
    """
    components, communication = configuration.components, configuration.communication
    named = {configuration.control.fail_safe, communication.transport, communication.console_transport}
    used = {name for name in components if name in named or name in ends}
    more = True
    while more:
        before = len(used)
        used |= {name for name, component in components.items() if _follows(component, used)}
        used |= {each.component for name in used & components.keys() for each in components[name].uses.values()}
        more = len(used) > before
    return used


def _follows(component: Component, used: Collection[str]) -> bool:
    """True for a component without ports, such as a guard, if the first component that it names is used."""
    if component.kind.ports or not component.uses:
        return False
    drives = [each.name for each in component.kind.uses if each.drive]
    names = [use.component for name, use in component.uses.items() if not drives or name in drives]
    return any(name in used for name in names)


def _report(component: Component, configuration: Configuration, diagnostics: Diagnostics) -> None:
    name, fail_safe = component.name, configuration.control.fail_safe
    if not can_stop(component, configuration.components):
        what = "bind one of its ports" if component.kind.ports else "name it in 'communication.transport'"
        message = f"component '{name}' is not used"
        diagnostics.warning("unused-component", component.span, message, hint=f"{what}, or remove it")
        return
    if fail_safe is not None:
        message = f"input '{name}' is not used: only '{fail_safe}' stops the robot"
        hint = "bind an input of the model to it"
    else:
        message = f"input '{name}' is not used: it does not stop the robot"
        written = f"write 'control: {{fail_safe: {name}}}'"
        hint = f"{written}: the target is then disabled while this input is off"
        if _is_stop(component):
            others = configuration.components
            alone = [name] == [each.name for each in others.values() if can_stop(each, others) and _is_stop(each)]
            hint = KeyValue(hint, configuration.tcf, ("control", "fail_safe"), name) if alone else hint
        else:
            hint = f"if it must stop the robot, {hint}; otherwise bind an input of the model to it"
    diagnostics.warning("unused-input", component.span, message, hint=hint)


def _is_stop(component: Component) -> bool:
    """True if the name says that the component stops the robot: ``emergency_stop``, ``estop`` or ``e_stop``."""
    known = {word for port in component.kind.ports for word in port.stop_words}
    return bool(known & words_of(component.name)) or component.name.casefold().replace("_", "") in known


def _driver_proposals(
    motors: Mapping[str, Component], model: Model, bindings: Bindings, components: Mapping[str, Component]
) -> dict[str, tuple[str, str]]:
    """The output that probably is meant for a motor, and the motor's component port, by the name of the motor.

    An output that is bound to a motor, or left unconnected on purpose, is meant for nothing else.
    """
    driving = {
        name: [end.component for end in ends if end.component in motors] for name, (_, ends) in bindings.outputs.items()
    }
    bound = {name: matches for name, matches in driving.items() if matches or not bindings.outputs[name][1]}
    matches = match_ports(model, components, bound)
    proposals = {port.name: matches[port.name].proposal or "" for port in model.outputs if port.name not in bound}
    return {
        reference.partition(".")[0]: (port, reference)
        for port, reference in proposals.items()
        if reference.partition(".")[0] in motors
    }


def _instead(port: str, reference: str, bindings: Bindings) -> str:
    """How to bind ``port`` to ``reference``, alone or in addition to the components that it has."""
    _, ends = bindings.outputs.get(port, (None, ()))
    if not ends:
        return f"write '{port}: {reference}'"
    others = ", ".join(end.component if end.port is None else f"{end.component}.{end.port}" for end in ends)
    return f"write '{port}: {reference}', or '{port}: [{reference}, {others}]' for both"
