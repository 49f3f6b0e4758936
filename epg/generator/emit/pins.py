# SPDX-License-Identifier: Apache-2.0
"""The pins that components drive or read, and the safe states of the driven pins."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from epg.generator.dataclass import dataclass
from epg.generator.emit.claims import claims_of
from epg.generator.emit.macros import Macros
from epg.generator.emit.text import Code
from epg.generator.emit.views import OutputGroup, SafeState
from epg.generator.resolve.allocation import AssignedPin


@dataclass(frozen=True)
class DigitalPin:
    """A pin that ``component`` reads or drives with two levels.

    ``role`` is the name that the component has for the pin, for example ``direction_a``.  ``node`` is the devicetree
    node that replaces the pin in the ``.tcf``, or "".  A PWM output is also such a pin, so that it can have its safe
    level.  ``plain`` is false if the platform reaches the pin by its peripheral only.
    """

    component: str
    role: str
    pin: AssignedPin
    node: str
    plain: bool
    drives: bool
    high: Code
    """Of an output: a C expression, true if the safe level is high."""
    invert: bool
    """Of an input: a low level is read as 1."""


def _digital_pins(macros: Macros) -> list[DigitalPin]:
    """The digital pins of all components, in the order of components, of their claims and of the signals."""
    app = macros.app
    components = {component.name: component for component in app.components}
    result = []
    for claim in claims_of(app):
        component = components[claim.component]
        declared = next(found for found in component.kind.claims if found.name == claim.name)
        drives, roles = declared.output, declared.signals
        resource_class = app.target.resource_class(claim.resource_class)
        assert resource_class is not None
        by_level = resource_class.peripheral is None
        if not drives and not by_level:
            continue
        plain = by_level or (app.target.has_pins and not claim.node)
        high = macros.safe_level(component, claim.name) if drives else Code("false")
        invert = bool(component.parameters.get("invert", False))
        for signal, pin in sorted(claim.pins.items()):
            role = roles.get(signal, signal)
            result.append(DigitalPin(component.name, role, pin, claim.node, plain, drives, high, invert))
    return result


def pin_lists(macros: Macros) -> dict[str, Sequence[object]]:
    """The template variables about digital pins: driven ones, read ones, and those that GPIO can reach."""
    pins = _digital_pins(macros)
    return {
        "output_pins": [pin for pin in pins if pin.drives],
        "input_pins": [pin for pin in pins if not pin.drives],
        "output_groups": _output_groups(macros),
        "gpios": [pin for pin in pins if pin.plain],
    }


def _output_groups(macros: Macros) -> list[OutputGroup]:
    """The driven pins, grouped by component, with the safe states of each component.

    A kind without ``safe_states`` has one: each pin at its safe level.
    """
    groups = []
    first = 0
    for component in macros.app.components:
        claims = [
            claim.name for claim in component.kind.claims if claim.output for _ in component.claims[claim.name].pins
        ]
        if claims:
            safe = {claim: "high" if macros.safe_level(component, claim) == "true" else "low" for claim in claims}
            states = tuple(_safe_state(claims, state) for state in component.kind.safe_states or [safe])
            groups.append(OutputGroup(component.name, first, len(claims), states))
            first += len(claims)
    return groups


def _safe_state(claims: Sequence[str], levels: Mapping[str, str]) -> SafeState:
    """One safe state of a kind as bit masks.  ``claims`` are the claims of the outputs, in the order of the bits."""

    def bits(level: str) -> int:
        return sum(1 << bit for bit, claim in enumerate(claims) if levels.get(claim) == level)

    return SafeState(bits("low"), bits("high"))
