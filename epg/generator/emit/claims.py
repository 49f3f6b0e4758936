# SPDX-License-Identifier: Apache-2.0
"""The hardware of an application, as the templates of platforms see it: each claim with the names of its assignment.

Platforms with a separate language for hardware, such as devicetree, need the names of peripherals and pins.  C needs
only their numbers.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import field
from fractions import Fraction

from epg.generator.dataclass import dataclass
from epg.generator.resolve.allocation import AssignedPin, Assignment
from epg.generator.resolve.application import Application
from epg.generator.resolve.claims import TICK


@dataclass(frozen=True)
class ClaimView:
    """A claim of ``component``.  ``component`` is empty for the claim of the control loop.

    ``label`` is unique among the claims of a resource class, and can be part of an identifier.  The other members are
    those of :class:`~epg.generator.resolve.allocation.Assignment`.
    """

    component: str
    name: str
    resource_class: str
    label: str
    instance: int
    slot: int
    instance_name: str
    slot_name: str
    pins: Mapping[str, AssignedPin]
    settings: Mapping[str, int]
    clock: Fraction | None
    frequency: Fraction | None
    attributes: Mapping[str, object] = field(default_factory=dict)
    node: str = ""


def claims_of(app: Application) -> list[ClaimView]:
    """The claims of all components, in the order of the components and of the claims in their kinds."""
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
            result.append(_view(app, component.name, claim.name, claim.resource_class, label, found))
    return result


def tick_of(app: Application) -> ClaimView | None:
    """The claim of the control loop for its tick.  None if the platform times the tick without a claimed peripheral."""
    if app.tick is None or app.target.tick is None:
        return None
    return _view(app, TICK[0], TICK[1], app.target.tick, TICK[1], app.tick)


def board_nodes(app: Application) -> list[str]:
    """The labels of devicetree nodes that the board enables and whose pins are assigned to components."""
    used = {pin.name for claim in claims_of(app) for pin in claim.pins.values()}
    return [label for label, pins in app.target.board.devicetree.items() if used.intersection(pins)]


def _view(
    app: Application, component: str, name: str, resource_class: str, label: str, assignment: Assignment
) -> ClaimView:
    same = ("instance", "slot", "instance_name", "slot_name", "settings", "clock", "frequency", "attributes", "node")
    stated = {member: getattr(assignment, member) for member in same}
    return ClaimView(component, name, resource_class, label, pins=assignment.signals, **stated)
