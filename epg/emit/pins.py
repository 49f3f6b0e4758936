# SPDX-License-Identifier: Apache-2.0
"""The pins that components drive or read, and the safe states of the driven pins."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from epg.catalog.kind import OUTPUT_CLASSES
from epg.emit.macros import Macros
from epg.emit.views import InputPin, OutputGroup, OutputPin, SafeState
from epg.resolve.application import Application


def output_pins(macros: Macros) -> list[OutputPin]:
    """The pins that components drive, in the order of components and of their claims."""
    return [
        OutputPin(component.name, signal, pin, macros.safe_level(component, claim.name))
        for component in macros.app.components
        for claim in component.kind.claims
        if claim.resource_class in OUTPUT_CLASSES
        for signal, pin in sorted(component.claims[claim.name].pins.items())
    ]


def input_pins(app: Application) -> list[InputPin]:
    """The pins of digital inputs."""
    return [
        InputPin(component.name, pin, bool(component.parameters.get("invert", False)))
        for component in app.components
        for claim in component.kind.claims
        if claim.resource_class == "digital_input"
        for pin in component.claims[claim.name].pins.values()
    ]


def output_groups(macros: Macros) -> list[OutputGroup]:
    """The pins of :func:`output_pins`, grouped by component, with the safe states of each component.

    A kind without ``safe_states`` has one: each pin at its safe level.
    """
    groups = []
    first = 0
    for component in macros.app.components:
        claims = [
            claim.name
            for claim in component.kind.claims
            if claim.resource_class in OUTPUT_CLASSES
            for _ in component.claims[claim.name].pins
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
