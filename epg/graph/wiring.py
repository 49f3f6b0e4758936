# SPDX-License-Identifier: Apache-2.0
"""Draws the wiring of a board: its contacts at their real positions, and the components that are soldered to them.

A wire starts at its contact, goes up or down in a separate lane, and ends at its component.  Contacts are on the lines
of a grid, and terminals of components are between these lines.  Wires therefore can cross, but never overlap.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

from epg.catalog.hardware import Target
from epg.catalog.kind import Kind
from epg.catalog.layout import Contact, Layout
from epg.check.configuration import Component
from epg.graph.svg import WIRES, Picture, width
from epg.resolve.allocation import Assignment
from epg.resolve.claims import ClaimKey

PITCH = 22.0
_INSIDE = 92.0  # from a contact to the middle of the board
_LANE = 9.0
_SMALL = 10.5
_RESISTOR = "10 kΩ to ground"


@dataclass(frozen=True)
class Terminal:
    """A connection of a component to ``contact``.  ``place`` is its line of the grid, from the top."""

    component: str
    signal: str
    contact: Contact
    place: int
    resource: str
    colour: int


@dataclass(frozen=True)
class _Part:
    """The part of a component that is drawn on one side of the board.

    ``divided`` is True if the component also has terminals on the other side.
    """

    component: Component
    terminals: tuple[Terminal, ...]
    colour: int
    divided: bool

    @property
    def middle(self) -> float:
        """The middle of its contacts, as a line of the grid."""
        return sum(terminal.place for terminal in self.terminals) / len(self.terminals)

    @property
    def rows(self) -> int:
        """The number of its terminals, with that of the ground."""
        return len(self.terminals) + 1

    @property
    def kind(self) -> str:
        return self.component.kind.name + (" (part)" if self.divided else "")


def terminals(
    target: Target, components: Mapping[str, Component], assignments: Mapping[ClaimKey, Assignment]
) -> dict[str, list[Terminal]]:
    """The terminals on each side of the board, "left" and "right", from the top down."""
    layout = target.board.layout
    assert layout is not None
    places = {side: _places(layout, side) for side in ("left", "right")}
    sides: dict[str, list[Terminal]] = {"left": [], "right": []}
    with_pins = [name for name, component in components.items() if component.kind.pins]
    for name in with_pins:
        for signal, pin, found in _signals(target, components[name].kind, _claims(name, assignments)):
            for side, contacts in places.items():
                for place, contact in contacts.items():
                    if contact.pin == pin:
                        colour = with_pins.index(name) % WIRES
                        sides[side].append(Terminal(name, signal, contact, place, found.resource, colour))
    return {side: sorted(found, key=lambda terminal: terminal.place) for side, found in sides.items()}


def _claims(component: str, assignments: Mapping[ClaimKey, Assignment]) -> dict[str, Assignment]:
    return {claim: found for (name, claim), found in assignments.items() if name == component}


def _signals(target: Target, kind: Kind, claims: Mapping[str, Assignment]) -> Iterator[tuple[str, str, Assignment]]:
    """The signals of a component with these ``claims``, each with the pin of the SoC that carries it."""
    for claim in kind.claims:
        found = claims.get(claim.name)
        if found is None or not found.pins_are_real:
            continue
        for signal, pin in claim.signals.items():
            if signal in found.pins:
                yield pin, target.soc.pins[found.pins[signal]], found


def elsewhere(
    target: Target, components: Mapping[str, Component], assignments: Mapping[ClaimKey, Assignment]
) -> list[str]:
    """Texts about connections without a contact: their pins are used on the board, or not shown by its layout."""
    layout = target.board.layout
    assert layout is not None
    shown = {contact.pin for row in layout.rows for contact in row.contacts}
    result = []
    for name, component in components.items():
        for signal, pin, _ in _signals(target, component.kind, _claims(name, assignments)):
            if pin not in shown:
                onboard = target.board.onboard.get(pin)
                what = onboard.title if onboard is not None else "see the board's pinout"
                result.append(f"{name} {signal}: {target.board.pin_title(pin)}, {what}")
    return result


def printed_names(target: Target, pin: str) -> str:
    """The names of a SoC's pin that are printed on the board, and that differ from its title: ``D6``."""
    return " ".join(name for name, named in target.board.names.items() if named == pin)


def wire_texts(kind: Kind, claims: Mapping[str, Assignment], target: Target) -> list[str]:
    """The pin of each signal, such as ``a GP10``, of a component with these ``claims``.  Empty if there are no pins."""
    return [f"{signal} {target.board.pin_title(pin)}" for signal, pin, _ in _signals(target, kind, claims)]


def _places(layout: Layout, side: str) -> dict[int, Contact]:
    """The contacts of a side by their lines of the grid.  Between two rows of contacts, there is space for a title."""
    result: dict[int, Contact] = {}
    line = 0
    for row in layout.rows:
        if row.side == side:
            result |= {line + index: contact for index, contact in enumerate(row.contacts)}
            line += len(row.contacts) + 2
    return result


def draw_wiring(
    target: Target, components: Mapping[str, Component], assignments: Mapping[ClaimKey, Assignment], title: str
) -> str:
    """The picture as the text of an SVG file.  The board of ``target`` must have a layout."""
    board = target.board
    layout = board.layout
    assert layout is not None
    sides = terminals(target, components, assignments)
    others = elsewhere(target, components, assignments)
    picture = Picture(f"{title}: wiring of {board.summary}", _description(target, layout, sides, others))
    lines = 1 + max((max(_places(layout, side), default=0) for side in sides), default=0)
    high = lines * PITCH
    picture.box(-_INSIDE, -PITCH * 2, 2 * _INSIDE, high + PITCH * 2.5, "board", round=8)
    wide = width(layout.top, 12) + 20
    picture.box(-wide / 2, -PITCH * 2 - 8, wide, 26, "box")
    picture.text(0, -PITCH * 2 + 9, layout.top, "middle")
    picture.text(0, -PITCH * 2 - 28, title, "middle", 15, "bold")
    picture.text(0, -PITCH + 8, board.summary, "middle", 12, "bold")
    for side, found in sides.items():
        _contacts(picture, target, layout, side, {terminal.place: terminal.colour for terminal in found})
        other = {terminal.component for name, there in sides.items() if name != side for terminal in there}
        _side(picture, layout, side, _parts(components, found, other))
    used = {terminal.component for found in sides.values() for terminal in found}
    _notes(picture, layout, others, any(drives(components[name]) for name in used))
    return picture.render()


def _contacts(picture: Picture, target: Target, layout: Layout, side: str, used: Mapping[int, int]) -> None:
    """Draws the contacts of a side.  ``used`` maps lines of the grid to the colour of their wires.

    A used contact is a square, so that it differs from free ones without its colour, too.
    """
    sign = -1 if side == "left" else 1
    anchor = "start" if side == "left" else "end"
    for place, contact in _places(layout, side).items():
        y = place * PITCH
        role = layout.role(contact)
        printed = printed_names(target, contact.pin) if contact.pin else ""
        name = " ".join(filter(None, (target.board.pin_title(contact.pin), printed))) if contact.pin else contact.name
        note = layout.supplies[contact.name].title if not contact.pin else ""
        style = "contact" if role == "pin" else role
        x = sign * _INSIDE
        half, round = (6, 1) if place in used else (5, 5)
        style = f"used t{used[place]}" if place in used else style
        shown = f"contact {contact.number}: {name}{': ' if note else ''}{note}"
        picture.box(x - half, y - half, 2 * half, 2 * half, style, shown, round)
        if place not in used:
            _sign(picture, x, y, role)
        picture.text(x - sign * 12, y + 4, str(contact.number), anchor, _SMALL, "faint")
        weight = "bold" if place in used or role in ("ground", "supply") else ""
        picture.text(x - sign * 34, y + 4, name, anchor, 11, weight)
    line = 0
    for row in layout.rows:
        if row.side == side:
            picture.text(sign * (_INSIDE - 12), line * PITCH - 14, row.title, anchor, 11, "bold")
            line += len(row.contacts) + 2


def _sign(picture: Picture, x: float, y: float, role: str) -> None:
    """Draws the sign of a contact that is not a pin, so that roles differ without their colours, too."""
    if role == "supply":
        picture.line([(x - 3.4, y), (x + 3.4, y)], "sign")
        picture.line([(x, y - 3.4), (x, y + 3.4)], "sign")
    elif role == "other":
        picture.line([(x - 2.4, y - 2.4), (x + 2.4, y + 2.4)], "sign")


def _parts(components: Mapping[str, Component], found: Sequence[Terminal], other: set[str]) -> list[_Part]:
    """The components of a side, sorted by the middle of their contacts.

    The components in ``other`` also have terminals on the opposite side.
    """
    groups: dict[str, list[Terminal]] = {}
    for terminal in found:
        groups.setdefault(terminal.component, []).append(terminal)
    parts = [_Part(components[name], tuple(own), own[0].colour, name in other) for name, own in groups.items()]
    return sorted(parts, key=lambda part: part.middle)


def drives(component: Component) -> bool:
    """True if the board drives the wires of a component.

    Such a wire needs a resistor, because it floats until the firmware runs.
    """
    return any(port.actuator for port in component.kind.ports)


def _side(picture: Picture, layout: Layout, side: str, parts: Sequence[_Part]) -> None:
    if not parts:
        return
    sign = -1 if side == "left" else 1
    places = _places(layout, side)
    grounds = _grounds([place for place, contact in places.items() if layout.role(contact) == "ground"], parts)
    labels = max(width(f"{t.component} {t.signal}", _SMALL) for part in parts for t in part.terminals)
    near = _INSIDE + 14 + labels + 10  # the position of the first lane
    edge = near + sum(part.rows for part in parts) * _LANE + 10  # the inner edge of the components
    wide = 24 + max(
        max(width(part.component.name), width(part.kind, _SMALL), width(_RESISTOR, _SMALL)) for part in parts
    )
    wires: list[_Wire] = []
    for part, first, ground in zip(parts, _lines(parts, max(places)), grounds, strict=True):
        top = first * PITCH - 32
        high = part.rows * PITCH + (54 if drives(part.component) else 38)
        x = edge if sign > 0 else -edge - wide
        picture.box(x, top, wide, high, "box", part.component.kind.summary)
        tx = x + 12 if sign > 0 else x + wide - 12
        anchor = "start" if sign > 0 else "end"
        picture.text(tx, top + 15, part.component.name, anchor, 12, f"bold t{part.colour}")
        picture.text(tx, top + 29, part.kind, anchor, _SMALL, "faint")
        for index, terminal in enumerate(part.terminals):
            y = (first + index + 0.5) * PITCH
            picture.text(tx, y + 4, terminal.signal, anchor, 11)
            what = f"{terminal.component} {terminal.signal}"
            wires.append(_Wire(terminal.place, y, what, f"{what}: {terminal.resource}", f"w{part.colour}"))
        y = (first + part.rows - 0.5) * PITCH
        picture.text(tx, y + 4, "GND", anchor, 11)
        if ground is not None:
            wires.append(_Wire(ground, y, "", f"ground of {part.component.name}", "earth"))
        if drives(part.component):
            picture.text(tx, top + high - 9, _RESISTOR, anchor, _SMALL, "faint")
    _wires(picture, sign, near, edge, wires)


def _lines(parts: Sequence[_Part], last: int) -> list[int]:
    """For each component, the line of the grid just above its first terminal.

    Components are as near to their contacts as possible, one below the other.
    """
    firsts: list[int] = []
    free = -len(parts) * 8
    for part in parts:
        first = max(free + 2, round(part.middle - part.rows / 2))
        firsts.append(first)
        free = first + part.rows + 1
    below = max(0, free - 1 - last)  # lines below the end of the board; move all up by half of them
    return [first - below // 2 for first in firsts]


def _grounds(grounds: Sequence[int], parts: Sequence[_Part]) -> list[int | None]:
    """The ground contact of each component, as a line of the grid; None if the side has none.

    If there are enough ground contacts, each component gets a different one, from the top down.  If not, each component
    gets the nearest one.
    """
    result: list[int | None] = []
    own = len(grounds) >= len(parts)
    start = 0
    for index, part in enumerate(parts):
        end = len(grounds) - (len(parts) - index - 1) if own else len(grounds)
        choice = range(start, end) if own else range(len(grounds))
        chosen = min(choice, key=lambda at: abs(grounds[at] - part.middle), default=None)
        result.append(None if chosen is None else grounds[chosen])
        start = 0 if chosen is None else chosen + 1
    return result


@dataclass(frozen=True)
class _Wire:
    """A wire from the contact at line ``place`` of the grid to the terminal at height ``y``, in pixels."""

    place: int
    y: float
    label: str
    title: str
    style: str


def _wires(picture: Picture, sign: int, near: float, edge: float, wires: Sequence[_Wire]) -> None:
    """Draws the wires, with lanes in the order in which the fewest wires cross.

    Wires that go down have the inner lanes, the lowest contact first.  Wires that go up have the outer lanes, the
    topmost contact first.
    """
    down = sorted((wire for wire in wires if wire.y > wire.place * PITCH), key=lambda wire: (-wire.place, -wire.y))
    up = sorted((wire for wire in wires if wire.y <= wire.place * PITCH), key=lambda wire: (wire.place, wire.y))
    for lane, wire in enumerate([*down, *up]):
        x, y = sign * (near + lane * _LANE), wire.place * PITCH
        picture.line([(sign * (_INSIDE + 5), y), (x, y), (x, wire.y), (sign * edge, wire.y)], wire.style, wire.title)
        anchor = "start" if sign > 0 else "end"
        picture.text(sign * (_INSIDE + 12), y - 5, wire.label, anchor, _SMALL, wire.style.replace("w", "t"))


def _notes(picture: Picture, layout: Layout, others: Sequence[str], driven: bool) -> None:
    """Writes the notes below the picture: the marks of contacts, the supplies of the board, and rules for all wires."""
    rows: dict[str, list[int]] = {}
    for contact in (contact for row in layout.rows for contact in row.contacts):
        if not contact.pin:
            rows.setdefault(contact.name, []).append(contact.number)
    texts = [(f"{name} ({', '.join(map(str, sorted(rows[name])))}): {layout.supplies[name].title}") for name in rows]
    marks = [("used t0", 1, "", "used: the colour is that of the wire"), ("contact", 5, "", "free pin")]
    for name, text in zip(rows, texts, strict=True):
        role = layout.supplies[name].role
        marks.append((role, 5, role, text))
    feeding = [f"{name} ({rows[name][0]})" for name in rows if layout.supplies[name].feeds_components]
    general = [*others, *layout.notes, "Seen from above. Dashed: grounds, which are all connected."]
    if feeding:
        general.append(f"VCC of encoders and other sensors: {' or '.join(feeding)}. Motors need a separate supply.")
    if driven:
        general.append(f"{_RESISTOR}: from each wire of the component, which floats until the firmware runs.")
    x = -max(width(text, 11) for text in [*texts, *general]) / 2
    y = picture.bottom + 34
    for style, round, role, text in marks:
        picture.box(x - 16, y - 9, 10, 10, style, round=round)
        _sign(picture, x - 11, y - 4, role)
        picture.text(x, y, text, size=11)
        y += 18
    for text in general:
        picture.text(x, y, text, size=11, style="faint")
        y += 18


def _description(target: Target, layout: Layout, sides: Mapping[str, Sequence[Terminal]], others: Sequence[str]) -> str:
    wires = [
        f"{t.component} {t.signal} to contact {t.contact.number} ({target.board.pin_title(t.contact.pin)})"
        for found in sides.values()
        for t in found
    ]
    told = "; ".join([*wires, *others]) or "no wires"
    return f"{target.board.summary} seen from above, {layout.top} at the top: {told}."
