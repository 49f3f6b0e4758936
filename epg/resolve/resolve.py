# SPDX-License-Identifier: Apache-2.0
"""Makes an :class:`~epg.resolve.application.Application` of a checked configuration, a model and bindings."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from fractions import Fraction
from pathlib import Path

from epg.check.bindings import Bindings
from epg.check.configuration import Component, Configuration
from epg.dataclass import dataclass
from epg.diagnostics import Diagnostics, Note
from epg.documents.schema import extended_from
from epg.models.model import Model
from epg.quantity import parse_quantity, show
from epg.resolve.allocation import Assignment, Hardware, allocate
from epg.resolve.application import Application, Plant, ResolvedComponent, Wire
from epg.resolve.claims import TICK, Claim, component_claims, tick_claims
from epg.resolve.counters import check_counters, longest_gap
from epg.resolve.motors import check_motors
from epg.resolve.other_code import clock_of, compare_clocks, divided_clocks, report_own_transports, report_streams
from epg.resolve.parameter_sizes import parameters_fit
from epg.resolve.parameters import parameter_settings, parameter_values, ros_parameters
from epg.resolve.topics import publications_of, subscriptions_of, value_indices_of
from epg.resolve.wires import Wiring

_SHORTEST, _LONGEST = Fraction(1, 1_000_000), Fraction(3600)
"""The limits of control periods in seconds.  The timer of a target can have narrower limits."""


@dataclass(frozen=True)
class PlantFiles:
    """A plant model, with the bindings of its ports to the sensors and actuators."""

    model: Model
    bindings: Bindings


def resolve(
    name: str,
    configuration: Configuration,
    model: Model,
    bindings: Bindings,
    plant: PlantFiles | None,
    diagnostics: Diagnostics,
    board: Hardware | None = None,
) -> Application | None:
    """The application ``name``, or None after reporting all reasons why its parts do not fit together.

    ``board`` are the assignments on a board, if a simulation of it must have its frequencies and steps of PWM.
    """
    errors = diagnostics.error_count
    check_model_name(bindings, model, diagnostics)
    period, divider = _period(configuration, model, diagnostics)
    assignments = allocate_hardware(configuration, period, diagnostics)
    if assignments is not None and board is not None:
        assignments = _with_steps(assignments, board)
    indices = value_indices_of(configuration.components, bindings)
    components = _components(configuration, assignments or {}, indices)
    wiring = Wiring(bindings, model, components, diagnostics)
    inputs, outputs = wiring.inputs(), wiring.outputs()
    settings = parameter_settings(bindings, model, diagnostics)
    for motor in bindings.motors.values():
        message = f"'{motor.duty}' is an input of a controller, not of a plant"
        hint = "'motors' belongs into the bindings of the plant"
        diagnostics.error("motors-of-controller", motor.span, message, hint=hint)
    served = ros_parameters(configuration.communication, model, diagnostics)
    if served and not parameters_fit(served, configuration, diagnostics):
        served = None
    simulated = _plant(plant, configuration, components, period, diagnostics) if plant else None
    _bound_ports(configuration.components, outputs, diagnostics)
    fail_safe = configuration.control.fail_safe
    communication = configuration.communication
    used: set[str | None] = {wire.component.name for wire in (*inputs, *outputs)}
    used |= {fail_safe, communication.transport, communication.console_transport}
    if simulated is not None:
        used |= {wire.component.name for wire in (*simulated.inputs, *simulated.outputs)}
    for component in configuration.components.values():
        usable = component.kind.ports or component.kind.transport
        if usable and component.name not in used and diagnostics.error_count == errors:
            what = "bind one of its ports" if component.kind.ports else "name it in 'communication.transport'"
            hint = f"{what}, or remove it"
            diagnostics.warning(
                "unused-component", component.span, f"component '{component.name}' is not used", hint=hint
            )
    if diagnostics.error_count > errors or assignments is None:
        return None
    return Application(
        name=name,
        target=configuration.target,
        target_span=configuration.root["target"].span,
        node=configuration.node,
        namespace=configuration.namespace,
        control=configuration.control,
        communication=communication,
        components=tuple(components.values()),
        model=model,
        inputs=inputs,
        outputs=outputs,
        parameters=parameter_values(settings),
        parameter_settings=settings,
        ros_parameters=served,
        subscriptions=subscriptions_of(components, configuration, inputs),
        publications=publications_of(components, configuration, parameters=served is not None),
        fail_safe=components[fail_safe] if fail_safe else None,
        tick=assignments.get(TICK),
        plant=simulated,
        period=period,
        step_divider=divider,
        files=_files(configuration, model, bindings, plant),
        absent=configuration.absent,
        others=configuration.others,
    )


def _with_steps(assignments: Hardware, board: Hardware) -> Hardware:
    """``assignments`` with the dividers of ``board``: the same frequencies and the same number of steps of a PWM."""
    result = dict(assignments)
    for key, found in board.items():
        if key in result and found.settings and result[key].settings:
            divided = {name: getattr(found, name) for name in ("settings", "clock", "frequency", "asked")}
            result[key] = replace(result[key], **divided)
    return result


def _bound_ports(components: Mapping[str, Component], outputs: Sequence[Wire], diagnostics: Diagnostics) -> None:
    """Reports parameters that need a port that no model output drives: homing needs the reset of an encoder."""
    driven = {(wire.component.name, wire.component_port.name) for wire in outputs}
    for component in components.values():
        for needed in component.kind.needs_bound:
            used = component.uses.get(needed.use)
            if needed.key not in component.node or used is None or (used.component, needed.port) in driven:
                continue
            other = components[used.component]
            hint = f"remove '{needed.key}' ('{needed.key}: null' if an extended file has set it)"
            if needed.port in [port.name for port in other.kind.ports]:
                message = f"'{needed.key}' needs '{other.name}.{needed.port}', but no model output is bound to it"
                hint = f"bind a model output to it, or {hint}"
            else:
                message = (
                    f"'{needed.key}' needs a port '{needed.port}', but '{other.name}' ({other.kind.name}) has none"
                )
            span = component.node.key_span(needed.key)
            notes = extended_from(component.node[needed.key])
            diagnostics.error("needs-bound", span, message, hint=hint, notes=notes)


def check_model_name(bindings: Bindings, model: Model, diagnostics: Diagnostics) -> None:
    """Reports bindings of another model."""
    if bindings.model != model.name:
        message = f"these bindings are for the model '{bindings.model}', but the model is '{model.name}'"
        notes = [Note("the model", model.span)]
        hint = f"write 'model: {model.name}', or name the other model"
        diagnostics.error("wrong-model", bindings.model_span, message, hint=hint, notes=notes)


def _period(configuration: Configuration, model: Model, diagnostics: Diagnostics) -> tuple[Fraction, int]:
    """The control period in seconds, and the number of control cycles for one step of the model.

    Reports periods, output delays and steps that are out of range or do not fit together.
    """
    period = configuration.control.period or model.step
    if not _SHORTEST <= period <= _LONGEST:
        stated = configuration.control.period is not None
        message = f"a control period of {show(period, 'time')} is out of range: must be from 1 us to 3600 s"
        notes = [] if stated else [Note("this is the model's step", model.span)]
        diagnostics.error("out-of-range", configuration.control.period_span, message, notes=notes)
        return Fraction(1, 1000), 1
    delay = configuration.control.output_delay
    if delay is not None and not 0 < delay < period:
        message = f"an output delay of {show(delay, 'time')} is out of range: "
        message += "must be more than 0 and less than the control period"
        notes = [Note(f"the control period is {show(period, 'time')}", configuration.control.period_span)]
        diagnostics.error("out-of-range", configuration.control.output_delay_span, message, notes=notes)
    ratio = model.step / period
    if ratio.denominator != 1:
        step, asked = _apart(model.step, period)
        message = f"the model's step of {step} is not a multiple of the control period of {asked}"
        exact = parse_quantity(step, "time") == model.step
        meant = f"set 'control: {{period: {step}}}'" if exact else "remove 'control.period'"
        hint = f"{meant} or export the model with another step"
        notes = [Note("the model", model.span)]
        diagnostics.error("step-not-multiple", configuration.control.period_span, message, hint=hint, notes=notes)
        return period, 1
    if ratio.numerator > 0xFFFF:
        message = f"the model would run in only one of {ratio.numerator} control cycles"
        diagnostics.error(
            "step-not-multiple", configuration.control.period_span, message, hint="use a longer control period"
        )
    return period, ratio.numerator


def allocate_hardware(
    configuration: Configuration, period: Fraction | None, diagnostics: Diagnostics
) -> Hardware | None:
    """The assignments for all components and for the timer of the control loop, or None after reporting mistakes.

    ``period`` is in seconds, or None if it is not known yet.
    """
    claims = [
        *component_claims(configuration),
        *tick_claims(configuration.target, period, configuration.control.period_span),
    ]
    return allocate_claims(claims, configuration, period, diagnostics)


def allocate_claims(
    claims: Sequence[Claim], configuration: Configuration, period: Fraction | None, diagnostics: Diagnostics
) -> Hardware | None:
    """As :func:`allocate_hardware`, for ``claims`` instead of those of the ``.tcf``: to try other pins."""
    target, others = configuration.target, configuration.others
    report_streams(configuration, claims, diagnostics)
    report_own_transports(configuration, diagnostics)
    found = allocate(claims, target, diagnostics, others)
    if found is not None:
        undivided = [name for name in target.clocks if name not in divided_clocks(target)]
        divided = [claim for claim in claims if found[claim.key].clock is not None]
        used = [clock_of(claim, found[claim.key].instance, target) for claim in divided]
        compare_clocks([*undivided, *used], target, others, diagnostics)
        gaps = {claim.key: longest_gap(found[claim.key], claim, target) for claim in claims}
        found = {key: replace(assignment, longest_gap=gaps[key]) for key, assignment in found.items()}
        if period is not None:
            check_counters(claims, found, target, period, configuration.control.period_span, diagnostics)
    return found


def _components(
    configuration: Configuration,
    assignments: Hardware,
    indices: Mapping[str, Mapping[str, int]],
) -> dict[str, ResolvedComponent]:
    claims: dict[str, dict[str, Assignment]] = {}
    for (owner, claim), found in assignments.items():
        claims.setdefault(owner, {})[claim] = found
    return {
        name: ResolvedComponent(**vars(component), claims=claims.get(name, {}), value_index=indices.get(name, {}))
        for name, component in configuration.components.items()
    }


def _plant(
    plant: PlantFiles,
    configuration: Configuration,
    components: Mapping[str, ResolvedComponent],
    period: Fraction,
    diagnostics: Diagnostics,
) -> Plant | None:
    """The plant, whose inputs come from actuators and whose outputs drive sensors.

    None after reporting that the platform does not simulate one.
    """
    model, bindings = plant.model, plant.bindings
    platform = configuration.target.platform
    if not platform.simulates_plant:
        span = bindings.model_span
        message = f"{platform.name} cannot simulate a plant"
        diagnostics.error("plant-not-simulated", span, message, hint="remove PLANT, or choose the target 'host'")
        return None
    ratio = period / model.step
    if ratio.denominator != 1:
        asked, step = _apart(period, model.step)
        message = f"the control period of {asked} is not a multiple of the plant's step of {step}"
        hint = "export the plant with a step that divides the period"
        diagnostics.error(
            "step-not-multiple", bindings.model_span, message, hint=hint, notes=[Note("the plant", model.span)]
        )
    if ratio > 0xFFFF:
        message = f"the plant would make {float(ratio):g} steps in every control period"
        hint = "export the plant with a longer step"
        diagnostics.error("step-not-multiple", bindings.model_span, message, hint=hint)
    wired = wired_plant(plant, components, diagnostics)
    return replace(wired, steps_per_period=max(1, ratio.numerator // ratio.denominator))


def wired_plant(plant: PlantFiles, components: Mapping[str, ResolvedComponent], diagnostics: Diagnostics) -> Plant:
    """The plant with the wires to the ``components`` that its bindings name.  Reports mistakes in the bindings."""
    model, bindings = plant.model, plant.bindings
    check_model_name(bindings, model, diagnostics)
    physical = {name: component for name, component in components.items() if not component.kind.communication}
    wiring = Wiring(bindings, model, physical, diagnostics, plant=True)
    inputs, outputs = wiring.inputs(), wiring.outputs()
    check_motors(bindings, model, diagnostics)
    return Plant(model, inputs, outputs, parameter_values(parameter_settings(bindings, model, diagnostics)))


def _files(
    configuration: Configuration, model: Model, bindings: Bindings, plant: PlantFiles | None
) -> tuple[Path, ...]:
    files = {*configuration.files, *model.files, bindings.path}
    if plant:
        files |= {*plant.model.files, plant.bindings.path}
    return tuple(sorted(files))


def _apart(one: Fraction, other: Fraction) -> tuple[str, str]:
    """Two different times with their units, with so many digits that the texts differ."""
    for digits in range(6, 18):
        texts = show(one, "time", digits=digits), show(other, "time", digits=digits)
        if texts[0] != texts[1]:
            return texts
    return f"{one} s", f"{other} s"
