# SPDX-License-Identifier: Apache-2.0
"""The functions by which the user's program reads and sets values by name: ``jiwy_set_setpoint_pan()``.

``templates/access.c.j2`` and ``templates/app.h.j2`` write their C.

Each function has a *word*, which is the C identifier of its port or parameter.  If an identifier belongs to several of
them, each of these words ends in ``_input``, ``_output`` or ``_parameter``.  So a name never changes its meaning when
the model gets another port: the program that uses it no longer compiles.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence

from epg.generator.dataclass import dataclass
from epg.generator.emit.model.render import parameter_constants
from epg.generator.emit.service import ParameterView, parameter_views
from epg.generator.emit.text import Code, double, identifier
from epg.generator.quantity import normal_unit
from epg.generator.resolve.application import Application, SetpointRules, Wire
from epg.generator.resolve.conversion import folded
from epg.generator.resolve.parameters import is_limited
from epg.generator.resolve.setpoints import computed_steps


@dataclass(frozen=True)
class PortAccess:
    """A port that can be read.  ``member`` is its place in ``<name>_values_t``."""

    word: Code
    name: str
    unit: str
    direction: str
    struct: Code
    member: Code


@dataclass(frozen=True)
class SetpointAccess:
    """A model input that can be set.  ``index`` is the index of its setpoint; ``notes`` are sentences about it."""

    word: Code
    name: str
    component: str
    unit: str
    index: int
    notes: tuple[str, ...]


@dataclass(frozen=True)
class ParameterAccess:
    """A parameter that can be read and set: ``constant`` of the model.  ``range`` is empty if it has no limits."""

    word: Code
    name: str
    unit: str
    constant: Code
    range: str


@dataclass(frozen=True)
class Access:
    """All functions.  ``shared`` is True if a middleware changes the parameters, too."""

    ports: tuple[PortAccess, ...]
    setpoints: tuple[SetpointAccess, ...]
    parameters: tuple[ParameterAccess, ...]
    parameter_table: tuple[ParameterView, ...]
    has_limits: bool
    shared: bool


def access_of(app: Application, shared: bool) -> Access:
    """The functions of ``app``.  ``shared`` is True if a middleware changes the parameters, too."""
    model = app.model
    tunable = [parameter for parameter in model.parameters if parameter.tunable]
    names = [(port.identifier, port.direction) for port in (*model.inputs, *model.outputs)]
    names += [(parameter.identifier, "parameter") for parameter in tunable]
    words = {name: identifier(word) for name, word in zip(names, unique_words(names), strict=True)}
    parameters = []
    # Tunable parameters come first in the model.  Therefore its constants are the indices in the table of parameters.
    names_in_model = parameter_constants(f"{app.name}_model", model.parameters)
    for constant, parameter in zip(names_in_model, tunable):
        setting = app.parameter_settings.get(parameter.name)
        limits = f"{setting.minimum:g} to {setting.maximum:g}" if setting and is_limited(setting) else ""
        word = words[parameter.identifier, "parameter"]
        parameters.append(ParameterAccess(word, parameter.name, parameter.unit, identifier(constant), limits))
    return Access(
        ports=tuple(
            PortAccess(
                words[port.identifier, port.direction],
                port.name,
                port.unit,
                port.direction,
                Code(f"{port.direction}s"),
                identifier(port.identifier),
            )
            for port in (*model.inputs, *model.outputs)
        ),
        setpoints=tuple(
            SetpointAccess(
                words[wire.port.identifier, "input"],
                wire.port.name,
                wire.component.kind.reference(wire.component.name, wire.component_port),
                _unit(wire),
                index,
                tuple(_notes(app, wire, index)),
            )
            for wire in app.inputs
            if (index := _setpoint(wire)) is not None
        ),
        parameters=tuple(parameters),
        parameter_table=tuple(parameter_views(app)),
        has_limits=any(is_limited(setting) for setting in app.parameter_settings.values()),
        shared=shared,
    )


def unique_words(names: Sequence[tuple[str, str]]) -> list[str]:
    """The words of functions for ``names``: pairs of an identifier and "input", "output" or "parameter".

    >>> unique_words([("x", "input"), ("x", "output"), ("y", "output"), ("x_output", "output")])
    ['x_input', 'x_output_2', 'y', 'x_output']
    """
    count = Counter(name for name, _ in names)
    taken = {name for name, number in count.items() if number == 1}
    result = []
    for name, kind in names:
        word = name if count[name] == 1 else f"{name}_{kind}"
        number, start = 2, word
        while count[name] > 1 and word in taken | set(count):
            word, number = f"{start}_{number}", number + 1
        taken.add(word)
        result.append(word)
    return result


def _setpoint(wire: Wire) -> int | None:
    """The index of the setpoint to which a model input is bound, or None."""
    is_topic = wire.component.kind.communication == "subscribe"
    return wire.component.value_index.get(wire.component_port.name) if is_topic else None


def _unit(wire: Wire) -> str:
    """The unit of the value that a message contains; empty if it is not known."""
    conversion = wire.component.conversion
    stated = conversion.unit if conversion.scale is None else None
    unit = normal_unit(wire.component_port.unit) or stated or ""
    return unit or ("" if wire.steps else wire.port.unit)


def _notes(app: Application, wire: Wire, index: int) -> Iterable[str]:
    """Sentences about the value: the conversion to the model's input, its fault handling, other inputs."""
    converted = _converted(wire)
    if converted != "the value":
        yield f"The model's input is {converted}."
    for topic in app.subscriptions:
        for value in topic.values:
            if value.index == index and value.setpoint is not None and topic.role == "values":
                yield from _handling(value.setpoint)
    others = [f"`{w.port.name}`" for w in app.inputs if w is not wire and _setpoint(w) == index]
    if others:
        yield f"Sets {', '.join(others)}, too."


def _converted(wire: Wire) -> str:
    """The conversion to the model's input as a formula: ``the value * 0.1 + 2.0``."""
    text = "the value"
    for step in folded(computed_steps(wire)):
        text += f" * {_number(step.scale)}" if step.scale != 1 else ""
        text += f" {'+' if step.offset > 0 else '-'} {_number(abs(step.offset))}" if step.offset != 0 else ""
    return text


def _handling(setpoint: SetpointRules) -> Iterable[str]:
    if setpoint.limits is not None:
        yield "A value outside of {} to {} is refused.".format(*map(_number, setpoint.limits))
    if setpoint.followed is not None:
        yield f"Enabling begins at `{setpoint.followed.measured.port.name}`; only later values act."
    elif setpoint.fresh:
        yield "Only values after the enabling act."
    if setpoint.rate_limit:
        yield f"It changes by at most {setpoint.rate_limit:g} per second."
    if setpoint.timeout:
        effect = {"hold": "it is kept", "zero": "it becomes 0", "disable": "the target is disabled"}
        yield f"After {float(setpoint.timeout):g} s without a new value {effect[setpoint.on_timeout]}."


def _number(value: object) -> str:
    return str(double(value))
