# SPDX-License-Identifier: Apache-2.0
"""The model's parameters with what the bindings state about them, and their names in ROS 2."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping

from epg.generator.check.bindings import Bindings, ParameterSetting
from epg.generator.check.communication import Communication
from epg.generator.check.names import ros_parameter_name
from epg.generator.dataclass import dataclass
from epg.generator.diagnostics import Diagnostics, Note, did_you_mean
from epg.generator.models.model import Model, Parameter
from epg.generator.source import Span


@dataclass(frozen=True)
class RosParameters:
    """The parameters that the ROS 2 node of a target serves.

    ``request`` is the size in bytes of the request buffer; None: it follows from the parameters.
    """

    parameters: tuple[Parameter, ...]
    request: int | None


def parameter_settings(bindings: Bindings, model: Model, diagnostics: Diagnostics) -> dict[str, ParameterSetting]:
    """The settings of parameters, by the model's own names.  Bindings can write ``.`` for ``\\``.

    Reports names that are not parameters, parameters that are set twice, and exported values outside of limits.
    """
    names = {parameter.name: parameter for parameter in model.parameters}
    for parameter in model.parameters:
        names.setdefault(parameter.name.replace("\\", "."), parameter)
    result: dict[str, ParameterSetting] = {}
    for written, setting in bindings.parameters.items():
        if written not in names:
            hint = did_you_mean(written, [p.name for p in model.parameters], f"parameters of {model.name}")
            hint = hint if model.parameters else f"{model.name} has no parameters"
            diagnostics.error(
                "unknown-parameter", setting.span, f"{model.name} has no parameter '{written}'", hint=hint
            )
        elif names[written].name in result:
            diagnostics.error("bound-twice", setting.span, f"parameter '{names[written].name}' is set twice")
        else:
            parameter = names[written]
            result[parameter.name] = setting
            if parameter.whole:
                limits = setting.minimum, setting.maximum
                report_inexact_limits(parameter.name, limits, setting.span, diagnostics)
            if setting.value is None and not setting.minimum <= parameter.value <= setting.maximum:
                message = f"the exported value {parameter.value:g} of '{parameter.name}' is outside of its limits"
                hint = "state a 'value' within the limits, or other limits"
                note = Note("the parameter", parameter.span)
                diagnostics.error("out-of-range", setting.span, message, hint=hint, notes=[note])
    return result


def report_inexact_limits(name: str, limits: Iterable[float], span: Span, diagnostics: Diagnostics) -> None:
    """Reports finite ``limits`` of a whole number that are beyond 2^53 in size: doubles have not all numbers there."""
    for limit in limits:
        if math.isfinite(limit) and abs(limit) > 2**53:
            message = f"the limit {limit:g} of '{name}' is too large for a whole number"
            hint = f"write limits from {-(2**53)} to {2**53}: larger whole numbers are not exact"
            diagnostics.error("out-of-range", span, message, hint=hint)
            return


def parameter_values(settings: Mapping[str, ParameterSetting]) -> dict[str, float]:
    """The values that replace exported ones, by the names of the parameters."""
    return {name: setting.value for name, setting in settings.items() if setting.value is not None}


def ros_parameters(communication: Communication, model: Model, diagnostics: Diagnostics) -> RosParameters | None:
    """The parameters of the ROS 2 node, or None if the middleware serves none, or if there are none that can change.

    Reports parameters whose names are the same in ROS 2.
    """
    tunable = tuple(parameter for parameter in model.parameters if parameter.tunable)
    serves = {"services", "parameters"}.issubset(communication.middleware.uses)
    if communication.parameters is False or not serves or not tunable:
        return None
    _report_same_names(tunable, diagnostics)
    return RosParameters(tunable, communication.parameter_request)


def _report_same_names(parameters: Iterable[Parameter], diagnostics: Diagnostics) -> None:
    taken: dict[str, Parameter] = {}
    for parameter in parameters:
        name = ros_parameter_name(parameter.name)
        other = taken.setdefault(name, parameter)
        if other is not parameter:
            message = f"the parameters '{other.name}' and '{parameter.name}' have the same name '{name}' in ROS 2"
            hint = "rename one of them in the model, or write 'parameters: false' in 'communication'"
            note = Note("the other one", other.span)
            diagnostics.error("same-parameter-name", parameter.span, message, hint=hint, notes=[note])


def is_limited(setting: ParameterSetting) -> bool:
    """True if the value of the parameter has a lower or an upper limit."""
    return math.isfinite(setting.minimum) or math.isfinite(setting.maximum)
