# SPDX-License-Identifier: Apache-2.0
"""The connections of components to the contacts of a board: the facts that the drawing of its wiring shows."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from epg.generator.catalog.board_layout import Contact, Layout
from epg.generator.catalog.hardware import Computer
from epg.generator.catalog.kind import Kind
from epg.generator.check.configuration import Component
from epg.generator.dataclass import dataclass
from epg.generator.resolve.allocation import Assignment
from epg.generator.resolve.claims import ClaimKey
from epg.graph.svg import WIRES

SIDES = ("left", "right", "top", "bottom")


@dataclass(frozen=True)
class Terminal:
    """A connection of a component to ``contact``.  ``place`` is its line of the grid, from the top or from the left.

    ``on_board`` is True if the board itself has this wire.
    """

    component: str
    signal: str
    contact: Contact
    place: float
    resource: str
    colour: int
    on_board: bool = False


def terminals(
    target: Computer, components: Mapping[str, Component], assignments: Mapping[ClaimKey, Assignment]
) -> dict[str, list[Terminal]]:
    """The terminals on each side of the board, from the top down or from the left to the right."""
    layout = target.board.layout
    assert layout is not None
    places = {side: places_of(layout, side) for side in SIDES}
    sides: dict[str, list[Terminal]] = {side: [] for side in SIDES}
    with_pins = [name for name, component in components.items() if component.kind.pins]
    for name in with_pins:
        for signal, pin, assignment in _signals(target, components[name].kind, _claims(name, assignments)):
            for side, contacts in places.items():
                for place, contact in contacts.items():
                    if contact.pin == pin:
                        colour = with_pins.index(name) % WIRES
                        on_board = pin in target.board.onboard
                        sides[side].append(
                            Terminal(name, signal, contact, place, assignment.resource, colour, on_board)
                        )
    return {side: sorted(group, key=lambda terminal: terminal.place) for side, group in sides.items()}


def _claims(component: str, assignments: Mapping[ClaimKey, Assignment]) -> dict[str, Assignment]:
    return {claim: found for (name, claim), found in assignments.items() if name == component}


def _signals(target: Computer, kind: Kind, claims: Mapping[str, Assignment]) -> Iterator[tuple[str, str, Assignment]]:
    """The signals of a component with these ``claims``, each with the pin of the SoC that carries it."""
    for claim in kind.claims:
        assignment = claims.get(claim.name)
        if assignment is None or not assignment.pins_are_real:
            continue
        for signal, pin in claim.signals.items():
            if signal in assignment.pins:
                yield pin, target.soc.pins[assignment.pins[signal]], assignment


def elsewhere(
    target: Computer, components: Mapping[str, Component], assignments: Mapping[ClaimKey, Assignment]
) -> list[str]:
    """Texts about signals without a contact: they have no pin yet, or it is used on the board, or it is not shown."""
    layout = target.board.layout
    assert layout is not None
    shown = {contact.pin for row in layout.rows for contact in row.contacts}
    result = []
    for name, component in components.items():
        pins = {signal: pin for signal, pin, _ in _signals(target, component.kind, _claims(name, assignments))}
        for signal, pin in pins.items():
            onboard = target.board.onboard.get(pin)
            if pin not in shown or onboard is not None:
                what = onboard.title if onboard is not None else "see the board's pinout"
                result.append(f"{name} {signal}: {target.board.pin_title(pin)}, {what}")
        if "node" not in component.node:
            result += [f"{name} {signal}: no pin" for signal in component.kind.pins if signal not in pins]
    return result


def printed_names(target: Computer, pin: str) -> str:
    """The names of a SoC's pin that are printed on the board, and that differ from its title: ``D6``."""
    return " ".join(name for name, named in target.board.names.items() if named == pin)


def wire_texts(kind: Kind, claims: Mapping[str, Assignment], target: Computer) -> list[str]:
    """The pin of each signal, such as ``a GP10``, of a component with these ``claims``.  Empty if there are no pins."""
    return [f"{signal} {target.board.pin_title(pin)}" for signal, pin, _ in _signals(target, kind, claims)]


def places_of(layout: Layout, side: str) -> dict[float, Contact]:
    """The contacts of a side by their lines of the grid.  Between two rows of contacts, there is space for a title."""
    result: dict[float, Contact] = {}
    line = 0
    for row in layout.rows:
        if row.side == side:
            result |= {line + index: contact for index, contact in enumerate(row.contacts)}
            line += len(row.contacts) + 2
    return result
