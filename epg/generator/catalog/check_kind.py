# SPDX-License-Identifier: Apache-2.0
"""Checks names, ranges and defaults in the files of component kinds, which their schema cannot check."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from epg.generator.catalog.parameter import COMMON_PARAMETERS, parameter_problems
from epg.generator.diagnostics import Diagnostics, Note
from epg.generator.documents.items import elements_of, flag_of, map_of, texts_of
from epg.generator.source import Span, YamlNode

_SETPOINT_PARAMETERS = {
    "initial": "type: number",
    "rate_limit": "type: number",
    "timeout": "quantity: time",
    "on_timeout": "type: string",
}
_PUBLICATION_PARAMETERS = {"every": "type: integer", "on_change": "type: boolean"}
_CHOICES = {"qos": ("reliable", "best_effort"), "on_timeout": ("hold", "zero", "disable")}
_OUTPUTS = 8
_DIMENSIONS = {"frequency": "frequency", "period": "time"}


def check_kind(node: YamlNode, diagnostics: Diagnostics) -> None:
    """Reports the mistakes in the file of a kind."""
    parameters = map_of(node, "parameters")
    for name, parameter in parameters.items():
        span = node["parameters"].key_span(name)
        if name in (*COMMON_PARAMETERS, "pins"):
            message = f"'{name}' is a key that every component has"
            diagnostics.error("invalid-name", span, message, hint="choose another name for the parameter")
        parameter_problems(name, parameter, span, diagnostics)
    uses = map_of(node, "uses")
    for name in uses:
        span = node["uses"].key_span(name)
        if name in (*COMMON_PARAMETERS, "pins"):
            message = f"'{name}' is a key that every component has"
            diagnostics.error("invalid-name", span, message, hint="choose another name")
        elif name in parameters:
            message = f"'{name}' is already the name of a parameter"
            notes = [Note("the parameter", node["parameters"].key_span(name))]
            diagnostics.error("invalid-name", span, message, hint="choose another name", notes=notes)
    _relations(node, {**parameters, **uses}, uses, diagnostics)
    _ports(node, parameters, diagnostics)
    _claims(node, parameters, diagnostics)
    _safe_states(node, diagnostics)
    if "communication" in node:
        _communication(node, parameters, diagnostics)


def _communication(node: YamlNode, parameters: Mapping[str, YamlNode], diagnostics: Diagnostics) -> None:
    """Checks the parameters of a kind with ``communication`` that EPG itself reads: they must have certain types."""
    direction = str(node["communication"].value)
    topics = {"from": "type: string", "to": "type: string"} if direction == "echo" else {"topic": "type: string"}
    for name in (*topics, "qos"):
        if name not in parameters:
            message = f"a kind with 'communication: {direction}' must have a parameter '{name}'"
            diagnostics.error("missing-key", node.key_span("communication"), message)
    wanted = {**topics, "qos": "type: string", "depth": "type: integer"}
    wanted |= {"subscribe": _SETPOINT_PARAMETERS, "publish": _PUBLICATION_PARAMETERS}.get(direction, {})
    for name, described in wanted.items():
        if name in parameters:
            span = node["parameters"].key_span(name)
            _communication_parameter(name, described, parameters[name], name in topics, span, diagnostics)


def _communication_parameter(
    name: str, described: str, parameter: YamlNode, is_topic: bool, span: Span, diagnostics: Diagnostics
) -> None:
    """Checks a parameter of a kind with ``communication``, which must have the key and value ``described``."""
    key, _, value = described.partition(": ")
    if key not in parameter or parameter[key].value != value:
        message = f"parameter '{name}' of a kind with 'communication' must have '{described}'"
        diagnostics.error("wrong-value", span, message)
    if is_topic and not flag_of(parameter, "required"):
        message = f"parameter '{name}' of a kind with 'communication' must be required"
        diagnostics.error("wrong-value", span, message, hint="add 'required: true'")
    if name == "qos" and "default" not in parameter and not flag_of(parameter, "required"):
        message = "parameter 'qos' of a kind with 'communication' must be required or have a default"
        diagnostics.error("wrong-value", span, message, hint="add 'default: reliable'")
    possible = texts_of(parameter, "enum")
    known = _CHOICES.get(name)
    if known and not (possible and set(possible) <= set(known)):
        message = f"parameter '{name}' of a kind with 'communication' must be one of {', '.join(known)}"
        diagnostics.error("wrong-value", span, message, hint=f"write 'enum: [{', '.join(known)}]'")


def _relations(node: YamlNode, parameters: Iterable[str], uses: Iterable[str], diagnostics: Diagnostics) -> None:
    """Checks ``relations``: all parameters and uses that they name must exist."""
    for relation in elements_of(node, "relations"):
        keys = ("exactly_one", "at_least_one", "at_most_one")
        names = [name for key in keys for name in elements_of(relation, key)]
        if "needs_bound" in relation:
            names.append(relation["needs_bound"]["key"])
            _known("use", relation["needs_bound"]["use"], uses, diagnostics)
        if "only_with" in relation:
            names += [relation["only_with"]["key"], relation["only_with"]["needs"]]
        for name in names:
            _known("parameter", name, parameters, diagnostics)


def _ports(node: YamlNode, parameters: Mapping[str, YamlNode], diagnostics: Diagnostics) -> None:
    """Checks ports.  Each direction can have one default port, which must not be one with ``each``."""
    defaults: dict[str, tuple[str, Span]] = {}
    for name, port in map_of(node, "ports").items():
        span = node["ports"].key_span(name)
        direction = str(port["direction"].value)
        if "each" in port:
            _each(port, parameters, diagnostics)
        for condition in ("boolean_with", "integer_with"):
            _condition(port.get(condition), parameters, diagnostics)
        for key, what in (("actuator", "an actuator"), ("drive", "a port that drives a motor")):
            if flag_of(port, key) and direction != "sink":
                message = f"{what} must be a sink"
                diagnostics.error("wrong-value", port[key].span, message, hint="write 'direction: sink'")
        if flag_of(port, "default"):
            other, other_span = defaults.setdefault(direction, (name, span))
            if other != name:
                message = f"'{other}' is already the default {direction}"
                diagnostics.error("wrong-value", span, message, notes=[Note("the other one", other_span)])


def _condition(node: YamlNode | None, parameters: Mapping[str, YamlNode], diagnostics: Diagnostics) -> None:
    """Checks that the parameters exist on which the type of a port depends."""
    if node is None:
        return
    for key, _ in node.items():
        message = f"this kind has no parameter '{key}'"
        diagnostics.known_or_error("unknown-name", node.key_span(key), message, key, parameters, "parameters")


def _each(port: YamlNode, parameters: Mapping[str, YamlNode], diagnostics: Diagnostics) -> None:
    """Checks a port with ``each``: this must name a required parameter of the type ``names`` or ``message``."""
    named = port["each"]
    _known("parameter", named, parameters, diagnostics)
    parameter = parameters.get(str(named.value))
    if parameter is not None and ("type" not in parameter or parameter["type"].value not in ("names", "message")):
        message = f"'each' must name a list, and parameter '{named.value}' is not a list"
        diagnostics.error("wrong-value", named.span, message, hint="give the parameter 'type: names'")
    elif parameter is not None and not flag_of(parameter, "required"):
        message = f"parameter '{named.value}' must be required: without it there are no ports"
        diagnostics.error("wrong-value", named.span, message, hint="add 'required: true' to the parameter")
    if flag_of(port, "default"):
        diagnostics.error("wrong-value", port["default"].span, "a port with 'each' cannot be the default port")


def _claims(node: YamlNode, parameters: Mapping[str, YamlNode], diagnostics: Diagnostics) -> None:
    """Checks ``claims``: their pins and parameters must exist, and each pin must be claimed once."""
    pins = texts_of(node, "pins")
    used: dict[str, Span] = {}
    parts = {
        f"{name}.{part}": child for name, p in parameters.items() for part, child in map_of(p, "properties").items()
    }
    parameters = {**parameters, **parts}
    for claim in map_of(node, "claims").values():
        for pin in map_of(claim, "signals").values():
            _known("pin", pin, pins, diagnostics)
            first = used.setdefault(str(pin.value), pin.span)
            if first != pin.span:
                message = f"pin '{pin.value}' is claimed twice"
                diagnostics.error("wrong-value", pin.span, message, notes=[Note("first written here", first)])
        for attribute, parameter in map_of(claim, "attributes").items():
            _known("parameter", parameter, parameters, diagnostics)
            _attribute(attribute, parameter, parameters.get(str(parameter.value)), diagnostics)
    for pin in elements_of(node, "pins"):
        if pin.value not in used:
            hint = "name it in the signals of a claim"
            diagnostics.error("wrong-value", pin.span, f"no claim uses pin '{pin.value}'", hint=hint)


def _safe_states(node: YamlNode, diagnostics: Diagnostics) -> None:
    """Checks ``safe_states``: they must name outputs that the kind claims.

    targets/runtime/include/epg/outputs.h has room for 8 outputs of a component.
    """
    outputs = [name for name, claim in map_of(node, "claims").items() if flag_of(claim, "output")]
    if len(outputs) > _OUTPUTS:
        message = f"a kind can claim at most {_OUTPUTS} outputs, not {len(outputs)}"
        diagnostics.error("wrong-value", node["claims"].span, message)
    for state in elements_of(node, "safe_states"):
        for name, _ in state.items():
            message = f"'{name}' is not an output that this kind claims"
            diagnostics.known_or_error("unknown-name", state.key_span(name), message, name, outputs, "outputs")


def _attribute(attribute: str, named: YamlNode, parameter: YamlNode | None, diagnostics: Diagnostics) -> None:
    """Checks the parameter that gives a claim its ``attribute``.

    An attribute that sets a divider needs a parameter with a unit.  For a frequency, a whole number is possible, too: a
    rate per second, such as a baud rate.  Other attributes are compared with each other, so they cannot be objects.
    """
    if parameter is None:
        return
    wanted = _DIMENSIONS.get(attribute)
    if wanted == "frequency" and "type" in parameter and parameter["type"].value == "integer":
        return
    if wanted is not None and ("quantity" not in parameter or parameter["quantity"].value != wanted):
        message = f"attribute '{attribute}' must come from a parameter with 'quantity: {wanted}'"
        diagnostics.error("wrong-value", named.span, message)
    elif "type" in parameter and parameter["type"].value == "object":
        diagnostics.error("wrong-value", named.span, f"attribute '{attribute}' cannot come from an object")


def _known(what: str, node: YamlNode, known: Iterable[str], diagnostics: Diagnostics) -> None:
    message = f"this kind has no {what} '{node.value}'"
    diagnostics.known_or_error("unknown-name", node.span, message, node.value, known, f"{what}s")
