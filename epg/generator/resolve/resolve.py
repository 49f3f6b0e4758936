# SPDX-License-Identifier: Apache-2.0
"""Makes an :class:`~epg.generator.resolve.application.Application` of a checked configuration, a model and bindings."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from fractions import Fraction
from pathlib import Path

from epg.generator.check.bindings import Bindings
from epg.generator.check.configuration import Component, Configuration
from epg.generator.correction import Choice, KeyValue, proposals_of
from epg.generator.data import is_own_target_file
from epg.generator.dataclass import dataclass
from epg.generator.diagnostics import Diagnostics, Note
from epg.generator.documents.schema import extended_from
from epg.generator.models.model import Model
from epg.generator.quantity import parse_quantity, show
from epg.generator.resolve.allocation import Assignment, Assignments, allocate
from epg.generator.resolve.application import Application, Plant, ResolvedComponent, Wire
from epg.generator.resolve.claims import TICK, Claim, component_claims, tick_claims
from epg.generator.resolve.counters import check_counters, longest_gap
from epg.generator.resolve.motors import check_motors
from epg.generator.resolve.other_code import (
    clock_of,
    compare_clocks,
    divided_clocks,
    report_own_transports,
    report_streams,
)
from epg.generator.resolve.parameter_sizes import parameters_fit
from epg.generator.resolve.parameters import parameter_settings, parameter_values, ros_parameters
from epg.generator.resolve.setpoints import setpoints_of
from epg.generator.resolve.topics import publications_of, subscriptions_of, value_indices_of
from epg.generator.resolve.unused import report_unused
from epg.generator.resolve.wires import WireBuilder

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
    board: Assignments | None = None,
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
    wiring = WireBuilder(bindings, model, components, diagnostics)
    inputs, outputs = wiring.inputs(), wiring.outputs()
    setpoints = setpoints_of(components, inputs, bindings, diagnostics)
    settings = parameter_settings(bindings, model, diagnostics)
    for motor in bindings.motors.values():
        message = f"'{motor.duty}' is an input of a controller, not of a plant"
        hint = "'motors' belongs into the bindings of the plant"
        diagnostics.error("motors-of-controller", motor.span, message, hint=hint)
    served = ros_parameters(configuration.communication, model, diagnostics)
    if served and not parameters_fit(served, configuration, diagnostics):
        served = None
    simulated = _plant(plant, configuration, components, period, diagnostics) if plant else None
    _bound_ports(configuration, wiring, outputs, diagnostics)
    fail_safe = configuration.control.fail_safe
    communication = configuration.communication
    wires, complete = (*inputs, *outputs), diagnostics.error_count == errors
    report_unused(configuration, model, bindings, wires, simulated, diagnostics, complete=complete)
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
        subscriptions=subscriptions_of(components, configuration, setpoints),
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


def _with_steps(assignments: Assignments, board: Assignments) -> Assignments:
    """``assignments`` with the dividers of ``board``: the same frequencies and the same number of steps of a PWM."""
    result = dict(assignments)
    for key, found in board.items():
        if key in result and found.settings and result[key].settings:
            divided = {name: getattr(found, name) for name in ("settings", "clock", "frequency", "asked")}
            result[key] = replace(result[key], **divided)
    return result


def _bound_ports(
    configuration: Configuration, wiring: WireBuilder, outputs: Sequence[Wire], diagnostics: Diagnostics
) -> None:
    """Reports parameters that need a port that no model output drives: homing needs the reset of an encoder."""
    components = configuration.components
    driven = {(wire.component.name, wire.component_port.name) for wire in outputs}
    for component in components.values():
        for needed in component.kind.needs_bound:
            used = component.uses.get(needed.use)
            if needed.key not in component.node or used is None or (used.component, needed.port) in driven:
                continue
            other = components[used.component]
            left_out = _left_out(component, needed.key, configuration)
            if needed.port in [port.name for port in other.kind.ports]:
                reference = f"{other.name}.{needed.port}"
                message = f"'{needed.key}' needs '{reference}', but no model output is bound to it"
                hint = _remedies(wiring.wire_to(reference, outputs), left_out)
            else:
                message = (
                    f"'{needed.key}' needs a port '{needed.port}', but '{other.name}' ({other.kind.name}) has none"
                )
                hint = left_out
            span = component.node.key_span(needed.key)
            notes = extended_from(component.node[needed.key])
            diagnostics.error("needs-bound", span, message, hint=hint, notes=notes)


def _left_out(component: Component, key: str, configuration: Configuration) -> str:
    """The hint to remove a parameter.  It proposes the change unless another parameter would then be missing."""
    for names in component.kind.at_least_one:
        others = [name for name in names if name != key]
        if key in names and not any(name in component.node for name in others):
            listed = "' or '".join(others)
            return f"set '{listed}' of '{component.name}' in place of '{key}'"
    sentence = f"write '{key}: null' in '{component.name}'"
    if component.node[key].origins:
        file = Path(configuration.tcf).name
        own = is_own_target_file(configuration.tcf)
        sentence += f" of {file}" if not own else f", in a .tcf of your own that extends {file}"
    if not configuration.is_changed_by_tcf(component.node[key]):
        return sentence
    return KeyValue(sentence, configuration.tcf, ("components", component.name, key), None)


def _remedies(wire: str | None, left_out: str) -> str:
    """The hint for a parameter that needs a ``wire``: it is None if no output of the model is free for it.

    If one is free, but does not seem to be meant, the hint proposes nothing: the user knows the outputs.
    """
    if wire is None:
        return Choice(f"no output of the model is free for it: {left_out}", *proposals_of(left_out))
    sentence, wires = f"{wire}, or {left_out}", proposals_of(wire)
    return Choice(sentence, *wires, *proposals_of(left_out)) if wires else sentence


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
) -> Assignments | None:
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
) -> Assignments | None:
    """As :func:`allocate_hardware`, for ``claims`` instead of those of the ``.tcf``: to try other pins."""
    target, others = configuration.target, configuration.others
    report_streams(configuration, claims, diagnostics)
    report_own_transports(configuration, diagnostics)
    assignments = allocate(claims, target, diagnostics, others)
    if assignments is not None:
        undivided = [name for name in target.clocks if name not in divided_clocks(target)]
        divided = [claim for claim in claims if assignments[claim.key].clock is not None]
        used = [clock_of(claim, assignments[claim.key].instance, target) for claim in divided]
        compare_clocks([*undivided, *used], target, others, diagnostics)
        gaps = {claim.key: longest_gap(assignments[claim.key], claim, target) for claim in claims}
        assignments = {key: replace(assignment, longest_gap=gaps[key]) for key, assignment in assignments.items()}
        if period is not None:
            check_counters(claims, assignments, target, period, configuration.control.period_span, diagnostics)
    return assignments


def _components(
    configuration: Configuration,
    assignments: Assignments,
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
    wiring = WireBuilder(bindings, model, physical, diagnostics, plant=True)
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
