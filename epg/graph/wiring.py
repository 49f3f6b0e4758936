# SPDX-License-Identifier: Apache-2.0
"""Draws the wiring of a board: its contacts at their real positions, and the components that are soldered to them.

A wire starts at its contact, goes up or down in a separate lane, and ends at its component.  Contacts are on the lines
of a grid, and terminals of components are between these lines.  Wires therefore can cross, but never overlap.

Each state of a contact has a different shape or sign, so that states differ without their colours, too.  The page of
``epg connect`` shows the same drawing: for a signal that the user has chosen, with the states of its possible pins.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping, Sequence

from epg.catalog.hardware import Target
from epg.catalog.layout import Contact, Layout
from epg.check.configuration import Component
from epg.dataclass import dataclass
from epg.graph.svg import Picture, width
from epg.graph.terminals import Terminal, elsewhere, places_of, printed_names, terminals
from epg.resolve.allocation import Assignment
from epg.resolve.claims import ClaimKey
from epg.resolve.first_fit import Signal
from epg.resolve.pin_options import PinOption

_PITCH, _NARROW_PITCH = 22.0, 14.0  # between two contacts; the narrow one for boards with many
_MANY = 40  # lines of the grid, from which the narrow pitch is used
_INSIDE = 92.0  # from a contact to the middle of the board, at least
_HEAD = 44.0  # from the upper edge of the board to the first contact
_LANE = 9.0
_SMALL = 10.5
_RESISTOR = "10 kΩ to ground"


@dataclass(frozen=True)
class Choice:
    """A signal that the user has chosen, and its possible pins."""

    signal: Signal
    options: Sequence[PinOption]

    @property
    def title(self) -> str:
        return " ".join(self.signal)


@dataclass(frozen=True)
class _Frame:
    """The measures of a picture, in pixels: from the middle of the board to its contacts, and between two contacts."""

    inside: float
    pitch: float

    @property
    def gap(self) -> int:
        """The lines of the grid between the last terminal of a component and the first one of the next component."""
        return math.ceil(62 / self.pitch)


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


def draw_wiring(
    target: Target,
    components: Mapping[str, Component],
    assignments: Mapping[ClaimKey, Assignment],
    title: str,
    choice: Choice | None = None,
    wrong: Collection[Signal] = (),
    *,
    for_page: bool = False,
) -> str:
    """The picture as the text of an SVG file.  The board of ``target`` must have a layout.

    With ``choice``, the contacts show if they can have the chosen signal.  ``wrong`` are signals whose pin is an error.
    ``for_page`` adds the rectangles that react
    to a pointer: ``data-pin`` and ``data-signal`` name the contact or the terminal.
    """
    board = target.board
    layout = board.layout
    assert layout is not None
    sides = terminals(target, components, assignments)
    others = elsewhere(target, components, assignments)
    picture = Picture(f"{title}: wiring of {board.summary}", _description(target, layout, sides, others))
    lines = 1 + max((max(places_of(layout, side), default=0) for side in sides), default=0)
    names = [_contact_name(target, contact) for row in layout.rows for contact in row.contacts]
    inside = max(_INSIDE, 40 + max(width(name, 11) for name in names))
    frame = _Frame(inside, _PITCH if lines <= _MANY else _NARROW_PITCH)
    picture.box(-inside, -_HEAD, 2 * inside, lines * frame.pitch + _HEAD + 11, "board", round=8)
    if layout.top:
        wide = width(layout.top, 12) + 20
        picture.box(-wide / 2, -_HEAD - 8, wide, 26, "box")
        picture.text(0, -_HEAD + 9, layout.top, "middle")
    picture.text(0, -_HEAD - 38, title, "middle", 15, "bold")
    told = board.summary if layout.to_scale else f"{board.summary}, not to scale"
    picture.text(0, -_HEAD - 18, told, "middle", 12, "bold")
    states = {option.pin: option for option in choice.options} if choice is not None else {}
    seen: set[str] = set()
    for side, found in sides.items():
        seen |= _contacts(picture, target, frame, side, found, states, wrong, for_page)
        other = {each.component for name in sides if name != side for each in sides[name] if not each.on_board}
        soldered = [terminal for terminal in found if not terminal.on_board]
        _side(picture, layout, frame, side, _parts(components, soldered, other), for_page)
    used = {terminal.component for found in sides.values() for terminal in found if not terminal.on_board}
    _notes(picture, layout, others, any(drives(components[name]) for name in used), seen, choice)
    return picture.render()


def _contact_name(target: Target, contact: Contact) -> str:
    """The name of a contact; that of a pin is followed by the names on the board."""
    if not contact.pin:
        return contact.name
    return " ".join(filter(None, (target.board.pin_title(contact.pin), printed_names(target, contact.pin))))


def _contacts(
    picture: Picture,
    target: Target,
    frame: _Frame,
    side: str,
    found: Sequence[Terminal],
    options: Mapping[str, PinOption],
    wrong: Collection[Signal],
    for_page: bool,
) -> set[str]:
    """Draws the contacts of a side, and returns their states."""
    layout = target.board.layout
    assert layout is not None
    sign = -1 if side == "left" else 1
    anchor = "start" if side == "left" else "end"
    users: dict[int, list[Terminal]] = {}
    for terminal in found:
        users.setdefault(terminal.place, []).append(terminal)
    seen = set()
    for place, contact in places_of(layout, side).items():
        x, y = sign * frame.inside, place * frame.pitch
        state = _state(target, layout, contact, users.get(place, []), options)
        if any((terminal.component, terminal.signal) in wrong for terminal in users.get(place, [])):
            state = "wrong"
        seen.add(state)
        name = _contact_name(target, contact)
        note = _note(target, layout, contact, users.get(place, []), options)
        shown = f"contact {contact.title}: {name}" if contact.title else name
        shown += f": {note}" if note else ""
        colour = users[place][0].colour if place in users else 0
        _contact(picture, x, y, state, shown, colour)
        if contact.pin in options and options[contact.pin].state == "current":
            picture.box(x - 9, y - 7, 18, 14, "chosen", round=3)
        if contact.number is not None:
            picture.text(x - sign * 12, y + 4, str(contact.number), anchor, _SMALL, "faint")
        weight = "bold" if place in users or state in ("ground", "supply", "fits") else ""
        weight = "faint" if state in ("unfit", "reserved") else weight
        picture.text(x - sign * 34, y + 4, name, anchor, 11, weight)
        if for_page and contact.pin:
            left = x - 10 if sign < 0 else 4.0
            data = {"pin": target.board.pin_title(contact.pin)}
            picture.hit(left, y - frame.pitch / 2, frame.inside + 6, frame.pitch, data, shown)
    line = 0
    for row in layout.rows:
        if row.side == side:
            picture.text(sign * (frame.inside - 12), line * frame.pitch - 12, row.title, anchor, 11, "bold")
            line += len(row.contacts) + 2
    return seen


def _state(
    target: Target, layout: Layout, contact: Contact, users: Sequence[Terminal], options: Mapping[str, PinOption]
) -> str:
    """The state of a contact: "wrong" for a pin with two users, a role of the layout, or a state of its option."""
    if not contact.pin:
        return layout.role(contact)
    if len(users) > 1:
        return "wrong"
    option = options.get(contact.pin)
    if users and (option is None or option.state in ("current", "used")):
        return "used"
    if option is not None and option.state in ("fits", "unfit", "reserved"):
        return option.state
    return "reserved" if contact.pin in target.board.reserved else "contact"


def _note(
    target: Target, layout: Layout, contact: Contact, users: Sequence[Terminal], options: Mapping[str, PinOption]
) -> str:
    """The facts about a contact that the pointer shows."""
    if not contact.pin:
        return layout.supplies[contact.name].title
    used = " and ".join(f"{terminal.component} {terminal.signal}" for terminal in users)
    option = options.get(contact.pin)
    if option is not None and option.reason and option.state != "current":
        return option.reason
    onboard = target.board.onboard.get(contact.pin)
    return used or target.board.reserved.get(contact.pin, onboard.title if onboard is not None else "")


def _contact(picture: Picture, x: float, y: float, state: str, title: str = "", colour: int = 0) -> None:
    """Draws a contact: a square if it is used, a circle otherwise, with the sign of its state."""
    if state in ("used", "wrong"):
        picture.box(x - 6, y - 6, 12, 12, f"used t{colour}", title, 1)
        if state == "wrong":
            picture.box(x - 9, y - 9, 18, 18, "wrong", round=9)
        return
    half = 5.5 if state == "fits" else 5
    picture.box(x - half, y - half, 2 * half, 2 * half, state, title, half)
    _sign(picture, x, y, state)


def _sign(picture: Picture, x: float, y: float, state: str) -> None:
    """Draws the sign of a state."""
    if state == "supply":
        picture.line([(x - 3.4, y), (x + 3.4, y)], "sign")
        picture.line([(x, y - 3.4), (x, y + 3.4)], "sign")
    elif state == "other":
        picture.line([(x - 2.4, y - 2.4), (x + 2.4, y + 2.4)], "sign")
    elif state == "reserved":
        picture.line([(x - 3.4, y), (x + 3.4, y)], "sign")
    elif state == "fits":
        picture.box(x - 1.5, y - 1.5, 3, 3, "fits", round=1.5)
    elif state == "unfit":
        picture.line([(x - 3, y - 3), (x + 3, y + 3)], "cross")
        picture.line([(x - 3, y + 3), (x + 3, y - 3)], "cross")


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


def _side(picture: Picture, layout: Layout, frame: _Frame, side: str, parts: Sequence[_Part], for_page: bool) -> None:
    if not parts:
        return
    sign = -1 if side == "left" else 1
    places = places_of(layout, side)
    grounds = _grounds([place for place, contact in places.items() if layout.role(contact) == "ground"], parts)
    told: dict[int, list[str]] = {}
    for terminal in (each for part in parts for each in part.terminals):
        told.setdefault(terminal.place, []).append(f"{terminal.component} {terminal.signal}")
    labels = max(width(", ".join(texts), _SMALL) for texts in told.values())
    near = frame.inside + 14 + labels + 10  # the position of the first lane
    edge = near + sum(part.rows for part in parts) * _LANE + 10  # the inner edge of the components
    wide = 24 + max(
        max(width(part.component.name), width(part.kind, _SMALL), width(_RESISTOR, _SMALL)) for part in parts
    )
    wires: list[_Wire] = []
    for part, first, ground in zip(parts, _lines(parts, max(places), frame), grounds, strict=True):
        top = first * frame.pitch - 32
        high = part.rows * frame.pitch + (54 if drives(part.component) else 38)
        x = edge if sign > 0 else -edge - wide
        picture.box(x, top, wide, high, "box", part.component.kind.summary)
        tx = x + 12 if sign > 0 else x + wide - 12
        anchor = "start" if sign > 0 else "end"
        picture.text(tx, top + 15, part.component.name, anchor, 12, f"bold t{part.colour}")
        picture.text(tx, top + 29, part.kind, anchor, _SMALL, "faint")
        for index, terminal in enumerate(part.terminals):
            y = (first + index + 0.5) * frame.pitch
            picture.text(tx, y + 4, terminal.signal, anchor, 11)
            what = f"{terminal.component} {terminal.signal}"
            label = ", ".join(told.pop(terminal.place, []))  # the first wire of a contact has the label of all
            wires.append(
                _Wire(
                    terminal.place,
                    y,
                    label,
                    what + (f": {terminal.resource}" if terminal.resource else ""),
                    f"w{part.colour}",
                )
            )
            if for_page:
                data = {"signal": f"{terminal.component}.{terminal.signal}"}
                picture.hit(x, y - frame.pitch / 2, wide, frame.pitch, data, f"{what}: {terminal.contact.name}")
        y = (first + part.rows - 0.5) * frame.pitch
        picture.text(tx, y + 4, "GND", anchor, 11)
        if ground is not None:
            wires.append(_Wire(ground, y, "", f"ground of {part.component.name}", "earth"))
        if drives(part.component):
            picture.text(tx, top + high - 9, _RESISTOR, anchor, _SMALL, "faint")
    _wires(picture, frame, sign, near, edge, wires)
    for wire in wires if for_page else ():
        component, _, signal = wire.title.partition(":")[0].partition(" ")
        if wire.label:
            left = sign * (frame.inside + 14) if sign > 0 else -near
            data = {"signal": f"{component}.{signal}"}
            picture.hit(left, wire.place * frame.pitch - 14, near - frame.inside - 14, 18, data, wire.title)


def _lines(parts: Sequence[_Part], last: int, frame: _Frame) -> list[int]:
    """For each component, the line of the grid just above its first terminal.

    Components are as near to their contacts as possible, one below the other.
    """
    firsts: list[int] = []
    free = -len(parts) * 8 * frame.gap
    for part in parts:
        first = max(free + frame.gap - 1, round(part.middle - part.rows / 2))
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


def _wires(picture: Picture, frame: _Frame, sign: int, near: float, edge: float, wires: Sequence[_Wire]) -> None:
    """Draws the wires, with lanes in the order in which the fewest wires cross.

    Wires that go down have the inner lanes, the lowest contact first.  Wires that go up have the outer lanes, the
    topmost contact first.
    """
    pitch = frame.pitch
    down = sorted((wire for wire in wires if wire.y > wire.place * pitch), key=lambda wire: (-wire.place, -wire.y))
    up = sorted((wire for wire in wires if wire.y <= wire.place * pitch), key=lambda wire: (wire.place, wire.y))
    size, above = (_SMALL, 5) if pitch == _PITCH else (9.5, 4)
    anchor = "start" if sign > 0 else "end"
    for lane, wire in enumerate([*down, *up]):
        second = not wire.label and wire.style != "earth"  # at a contact that another wire uses, too
        x, y = sign * (near + lane * _LANE), wire.place * pitch + (4 if second else 0)
        points = [(sign * (frame.inside + 5), y), (x, y), (x, wire.y), (sign * edge, wire.y)]
        picture.line(points, wire.style, wire.title)
        style = wire.style.replace("w", "t")
        picture.text(sign * (frame.inside + 12), y - above, wire.label, anchor, size, style)


def _notes(
    picture: Picture,
    layout: Layout,
    others: Sequence[str],
    driven: bool,
    seen: Collection[str],
    choice: Choice | None,
) -> None:
    """Writes the notes below the picture: the states of contacts, the supplies of the board, and rules for all wires.

    ``seen`` are the states that the picture shows.
    """
    numbers: dict[str, dict[str, list[int]]] = {}  # contact -> row -> numbers
    for contact in (contact for row in layout.rows for contact in row.contacts):
        if not contact.pin and contact.number is not None:
            numbers.setdefault(contact.name, {}).setdefault(contact.row, []).append(contact.number)
    places = {
        name: "; ".join(f"{row} {', '.join(map(str, sorted(found)))}".strip() for row, found in rows.items())
        for name, rows in numbers.items()
    }
    texts = [f"{name} ({place}): {layout.supplies[name].title}" for name, place in places.items()]
    marks = [(state, text) for state, text in _legend(choice) if state in seen or state in ("used", "contact")]
    if choice is not None:
        marks.remove(("contact", _FREE))
    marks += [(layout.supplies[name].role, text) for name, text in zip(places, texts, strict=True)]
    feeding = [f"{name} ({place})" for name, place in places.items() if layout.supplies[name].feeds_components]
    general = [*others, *layout.notes, "Seen from above. Dashed: grounds, which are all connected."]
    if feeding:
        general.append(f"VCC of encoders and other sensors: {' or '.join(feeding)}. Motors need a separate supply.")
    if driven:
        general.append(f"{_RESISTOR}: from each wire of the component, which floats until the firmware runs.")
    x = -max(width(text, 11) for text in [*(text for _, text in marks), *general]) / 2
    y = picture.bottom + 34
    for state, text in marks:
        _contact(picture, x - 12, y - 4, state)
        picture.text(x, y, text, size=11)
        y += 20
    for text in general:
        picture.text(x, y, text, size=11, style="faint")
        y += 18


_FREE = "free pin"


def _legend(choice: Choice | None) -> list[tuple[str, str]]:
    """The states of contacts with a pin, and their meanings."""
    result = [
        ("used", "used: the colour is that of the wire"),
        ("wrong", "an error: see the messages"),
        ("contact", _FREE),
    ]
    if choice is not None:
        result += [("fits", f"can be {choice.title}"), ("unfit", f"cannot be {choice.title}")]
    return [*result, ("reserved", "reserved: used by the board itself, or by other code")]


def _told(target: Target, contact: Contact) -> str:
    title = target.board.pin_title(contact.pin)
    return f"contact {contact.title} ({title})" if contact.title else title


def _description(target: Target, layout: Layout, sides: Mapping[str, Sequence[Terminal]], others: Sequence[str]) -> str:
    wires = [
        f"{t.component} {t.signal} to {_told(target, t.contact)}"
        for found in sides.values()
        for t in found
        if not t.on_board
    ]
    told = "; ".join([*wires, *others]) or "no wires"
    return f"{target.board.summary} seen from above, {layout.top} at the top: {told}."
