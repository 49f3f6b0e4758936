# SPDX-License-Identifier: Apache-2.0
"""The hardware of an application as templates of platforms see it: every claim with the names of what it got.

For platforms whose hardware is described in a language of its own, such as devicetree; C gets along with numbers.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from fractions import Fraction

from epg.resolve.allocation import Assignment
from epg.resolve.application import Application
from epg.resolve.claims import TICK


@dataclass(frozen=True)
class PinView:
    """A pin: its name as the chip's data have it, and its number in C."""

    name: str
    number: int


@dataclass(frozen=True)
class ClaimView:
    """A claim of ``component`` (empty: the control loop).

    ``label`` is a name for it that no other claim has, and that can be part of an identifier.  ``roles`` are what the
    component calls the pins of ``pins``.  The rest is as in :class:`~epg.resolve.allocation.Assignment`.
    """

    component: str
    name: str
    resource_class: str
    label: str
    instance: int
    slot: int
    instance_name: str
    slot_name: str
    pins: Mapping[str, PinView]
    roles: Mapping[str, str]
    settings: Mapping[str, int]
    frequency: Fraction | None
    attributes: Mapping[str, object] = field(default_factory=dict)
    node: str = ""


def claims_of(app: Application) -> list[ClaimView]:
    """The claims of all components, in the order they are written."""
    labels: set[tuple[str, str]] = set()
    result = []
    for component in app.components:
        for claim in component.kind.claims:
            alone = len([other for other in component.kind.claims if other.resource_class == claim.resource_class]) == 1
            label = component.name if alone else f"{component.name}_{claim.name}"
            while (claim.resource_class, label) in labels:
                label += "_"
            labels.add((claim.resource_class, label))
            found = component.claims[claim.name]
            view = _view(app, component.name, claim.name, claim.resource_class, label, found)
            result.append(replace(view, roles={signal: claim.signals.get(signal, signal) for signal in found.pins}))
    return result


@dataclass(frozen=True)
class GpioView:
    """A pin that is read or driven by itself; a PWM output of a chip is one too, so that it can be made safe.

    ``role`` is what the component calls the pin: ``direction_a``.
    """

    component: str
    role: str
    pin: PinView
    node: str = ""


def gpios_of(app: Application) -> list[GpioView]:
    """The pins of all components that are digital inputs or outputs, or PWM outputs where pins are real."""
    classes = ("digital_input", "digital_output", *(("pwm",) if app.target.has_pins else ()))
    return [
        GpioView(claim.component, claim.roles[signal], pin, claim.node)
        for claim in claims_of(app)
        if claim.resource_class in classes and not (claim.resource_class == "pwm" and claim.node)
        for signal, pin in sorted(claim.pins.items())
    ]


def tick_of(app: Application) -> ClaimView | None:
    """The claim of the control loop; None where the platform times it without a peripheral."""
    if app.tick is None or app.target.tick is None:
        return None
    return _view(app, TICK[0], TICK[1], app.target.tick, TICK[1], app.tick)


def board_nodes(app: Application) -> list[str]:
    """Labels of nodes that the board's devicetree enables and whose pins the application's components have."""
    used = {pin.name for claim in claims_of(app) for pin in claim.pins.values()}
    return [label for label, pins in app.target.board.devicetree.items() if used.intersection(pins)]


def _view(app: Application, component: str, name: str, resource_class: str, label: str, found: Assignment) -> ClaimView:
    names = app.target.soc.pins if found.pins_are_real else ()
    return ClaimView(
        component=component,
        name=name,
        resource_class=resource_class,
        label=label,
        instance=found.instance,
        slot=found.slot,
        instance_name=found.instance_name,
        slot_name=found.slot_name,
        pins={signal: PinView(names[pin] if names else str(pin), pin) for signal, pin in found.pins.items()},
        roles={},
        settings=found.settings,
        frequency=found.frequency,
        attributes=found.attributes,
        node=found.node,
    )
