"""What the schema of component kinds cannot say: that names, ranges and defaults in them make sense."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from epg.check.compose import COMMON_PARAMETERS, parameter_problems
from epg.diagnostics import Diagnostics, Note, did_you_mean
from epg.load.items import map_of, texts_of
from epg.source import Node, Span

_TOPIC_PARAMETERS = ("topic", "qos")
_DIMENSIONS = {"frequency": "frequency", "period": "time"}


def check_kind(node: Node, diagnostics: Diagnostics) -> None:
    """A kind in itself."""
    parameters = map_of(node, "parameters")
    for name, parameter in parameters.items():
        span = node["parameters"].key_span(name)
        if name in (*COMMON_PARAMETERS, "pins"):
            message = f"'{name}' is a key that every component has"
            diagnostics.error("invalid-name", span, message, hint="choose another name for the parameter")
        parameter_problems(name, parameter, span, diagnostics)
    _relations(node, parameters, diagnostics)
    _ports(node, diagnostics)
    _claims(node, parameters, diagnostics)
    if "communication" in node:
        for name in _TOPIC_PARAMETERS:
            if name not in parameters:
                message = f"a kind with 'communication' has a parameter '{name}'"
                diagnostics.error("missing-key", node.key_span("communication"), message)


def _relations(node: Node, parameters: Iterable[str], diagnostics: Diagnostics) -> None:
    relations = node.get("relations")
    for relation in relations.elements() if relations else ():
        names = list(relation["exactly_one"].elements()) if "exactly_one" in relation else []
        if "only_with" in relation:
            names += [relation["only_with"]["key"], relation["only_with"]["needs"]]
        for name in names:
            _known("parameter", name, parameters, diagnostics)


def _ports(node: Node, diagnostics: Diagnostics) -> None:
    """At most one port of a direction is meant by the component's name alone."""
    defaults: dict[str, tuple[str, Span]] = {}
    for name, port in map_of(node, "ports").items():
        span = node["ports"].key_span(name)
        direction = str(port["direction"].value)
        if "actuator" in port and port["actuator"].value is True and direction != "sink":
            diagnostics.error(
                "wrong-value", port["actuator"].span, "an actuator is a sink", hint="write 'direction: sink'"
            )
        if "default" in port and port["default"].value is True:
            other, other_span = defaults.setdefault(direction, (name, span))
            if other != name:
                message = f"'{other}' is the default {direction} already"
                diagnostics.error("wrong-value", span, message, notes=[Note("the other one", other_span)])


def _claims(node: Node, parameters: Mapping[str, Node], diagnostics: Diagnostics) -> None:
    pins = texts_of(node, "pins")
    used: dict[str, Span] = {}
    for claim in map_of(node, "claims").values():
        for pin in map_of(claim, "signals").values():
            _known("pin", pin, pins, diagnostics)
            first = used.setdefault(str(pin.value), pin.span)
            if first != pin.span:
                message = f"pin '{pin.value}' is claimed twice"
                diagnostics.error("wrong-value", pin.span, message, notes=[Note("first here", first)])
        for attribute, parameter in map_of(claim, "attributes").items():
            _known("parameter", parameter, parameters, diagnostics)
            _attribute(attribute, parameter, parameters.get(str(parameter.value)), diagnostics)
    for pin in node["pins"].elements() if "pins" in node else ():
        if pin.value not in used:
            hint = "name it in the signals of a claim"
            diagnostics.error("wrong-value", pin.span, f"pin '{pin.value}' is in no claim", hint=hint)


def _attribute(attribute: str, named: Node, parameter: Node | None, diagnostics: Diagnostics) -> None:
    """Dividers are set from numbers with a unit; other attributes are compared, so they are single values."""
    if parameter is None:
        return
    wanted = _DIMENSIONS.get(attribute)
    if wanted is not None and ("quantity" not in parameter or parameter["quantity"].value != wanted):
        message = f"attribute '{attribute}' comes from a parameter with 'quantity: {wanted}'"
        diagnostics.error("wrong-value", named.span, message)
    elif "type" in parameter and parameter["type"].value == "object":
        diagnostics.error("wrong-value", named.span, f"attribute '{attribute}' cannot come from an object")


def _known(what: str, node: Node, known: Iterable[str], diagnostics: Diagnostics) -> None:
    names = list(known)
    if node.value not in names:
        hint = did_you_mean(str(node.value), names, f"{what}s")
        diagnostics.error("unknown-name", node.span, f"this kind has no {what} '{node.value}'", hint=hint)
