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

from epg.generator.catalog.board_layout import Contact, Layout
from epg.generator.catalog.hardware import Computer
from epg.generator.check.configuration import Component
from epg.generator.dataclass import dataclass
from epg.generator.resolve.allocation import Assignment
from epg.generator.resolve.claims import ClaimKey
from epg.generator.resolve.first_fit import ClaimSignal
from epg.generator.resolve.pin_options import PinOption
from epg.graph.edges import COLUMN, Detour, Edge, detours_of, edge_room, highest, moved
from epg.graph.svg import Picture, width
from epg.graph.terminals import Terminal, elsewhere, places_of, printed_names, terminals

_PITCH, _NARROW_PITCH = 22.0, 14.0  # between two contacts; the narrow one for boards with many
_MANY = 40  # lines of the grid, from which the narrow pitch is used
_INSIDE = 92.0  # from a contact to the middle of the board, at least
_HEAD = 44.0  # from the upper edge of the board to the first contact
_LANE = 9.0
_SMALL = 10.5
_RESISTOR = "10 kΩ to ground"


@dataclass(frozen=True)
class PinChoice:
    """A signal that the user has chosen, and its possible pins."""

    signal: ClaimSignal
    options: Sequence[PinOption]

    @property
    def title(self) -> str:
        return " ".join(self.signal)


@dataclass(frozen=True)
class _Frame:
    """The measures of a picture: from the middle of the board to its contacts, and between two of them, in pixels.

    ``lines`` is the number of lines of the grid.  The upper and the lower edge of the board are at ``top`` and
    ``bottom``; ``wide`` is the distance of two contacts there.
    """

    inside: float
    pitch: float
    lines: int
    top: float
    bottom: float
    wide: float

    @property
    def gap(self) -> int:
        """The lines of the grid between the last terminal of a component and the first one of the next component."""
        return math.ceil(62 / self.pitch)


@dataclass(frozen=True)
class _Side:
    """One side of the board in a picture.  ``for_page`` adds the rectangles that react to a pointer."""

    picture: Picture
    layout: Layout
    frame: _Frame
    name: str
    for_page: bool
    detours: Mapping[float, Detour]

    @property
    def sign(self) -> int:
        return -1 if self.name == "left" else 1

    @property
    def places(self) -> dict[float, Contact]:
        """The contacts that its wires can use, by their lines of the grid: from the top down, those at edges, too."""
        detours = {place: detour.contact for place, detour in self.detours.items()}
        return dict(sorted({**places_of(self.layout, self.name), **detours}.items(), key=lambda item: item[0]))

    def place(self, contact: Contact, line: float) -> tuple[float, float]:
        """The middle of the contact at a line of the grid.  Those of a pair are side by side between two lines."""
        x = self.frame.inside - (COLUMN if contact.inner else 0)
        return self.sign * x, (line + contact.pair / 2) * self.frame.pitch

    @property
    def inward(self) -> str:
        """The anchor of texts on the board, which begin or end at its contacts."""
        return "start" if self.name == "left" else "end"

    @property
    def outward(self) -> str:
        """The anchor of texts beside the board."""
        return "end" if self.name == "left" else "start"


@dataclass(frozen=True)
class _Pad:
    """A contact at a line of the grid, the terminals that use it, and its option for the signal that was chosen.

    ``wrong`` is True if the pin of one of these terminals is an error.
    """

    target: Computer
    layout: Layout
    place: float
    contact: Contact
    users: Sequence[Terminal]
    option: PinOption | None
    wrong: bool

    @property
    def state(self) -> str:
        """ "wrong", also for a pin with two users, a role of the layout, or a state of its option."""
        if self.wrong:
            return "wrong"
        if not self.contact.pin:
            return self.layout.role(self.contact)
        if len(self.users) > 1:
            return "wrong"
        if self.users and (self.option is None or self.option.state in ("current", "used")):
            return "used"
        if self.option is not None and self.option.state in ("fits", "unfit", "reserved"):
            return self.option.state
        return "reserved" if self.contact.pin in self.target.board.reserved else "contact"

    @property
    def note(self) -> str:
        """The facts about the contact that the pointer shows."""
        if not self.contact.pin:
            return self.layout.supplies[self.contact.name].title
        if self.option is not None and self.option.reason and self.option.state != "current":
            return self.option.reason
        used = " and ".join(f"{terminal.component} {terminal.signal}" for terminal in self.users)
        onboard = self.target.board.onboard.get(self.contact.pin)
        return used or self.target.board.reserved.get(self.contact.pin, onboard.title if onboard is not None else "")

    @property
    def title(self) -> str:
        name = _contact_name(self.target, self.contact)
        shown = f"contact {self.contact.title}: {name}" if self.contact.title else name
        return f"{shown}: {self.note}" if self.note else shown

    @property
    def weight(self) -> str:
        """The style of its name."""
        if self.state in ("unfit", "reserved"):
            return "faint"
        return "bold" if self.users or self.state in ("ground", "supply", "fits") else ""


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
    target: Computer,
    components: Mapping[str, Component],
    assignments: Mapping[ClaimKey, Assignment],
    title: str,
    choice: PinChoice | None = None,
    wrong: Collection[ClaimSignal] = (),
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
    frame = _frame(target, layout)
    edges = _edges(layout, frame)
    detours = detours_of(layout, edges, sides)
    soldered = {side: moved(side, ways, sides, frame.pitch) for side, ways in detours.items()}
    others = elsewhere(target, components, assignments)
    picture = Picture(f"{title}: wiring of {board.summary}", _description(target, layout, soldered, others))
    _board(picture, layout, frame, board.summary, title, highest(detours))
    seen: set[str] = set()
    for edge in edges:
        pads = _pads(target, layout, edge.name, sides[edge.name], choice, wrong)
        seen.update(pad.state for pad in pads)
        _edge_contacts(picture, layout, edge, pads, for_page)
    for name in soldered:
        ways = {detour.y / frame.pitch: detour for detour in detours[name]}
        side = _Side(picture, layout, frame, name, for_page, ways)
        pads = _pads(target, layout, name, sides[name], choice, wrong)
        seen.update(pad.state for pad in pads)
        _contacts(side, pads)
        _row_titles(side)
        _soldered(side, _parts(components, soldered[name], _components_beside(soldered, name)))
    driven = any(drives(components[each.component]) for contents in soldered.values() for each in contents)
    rules = _rules(layout, others, driven=driven)
    _notes(picture, _marks(layout, seen, choice), rules)
    return picture.render()


def _components_beside(soldered: Mapping[str, Sequence[Terminal]], side: str) -> set[str]:
    """The components that have terminals on the side opposite to ``side``."""
    return {each.component for name, there in soldered.items() if name != side for each in there}


def _edges(layout: Layout, frame: _Frame) -> list[Edge]:
    """The top and the bottom, if they have contacts."""
    edges = [Edge(each, places_of(layout, each), frame.wide, getattr(frame, each)) for each in ("top", "bottom")]
    return [edge for edge in edges if edge.contacts]


def _frame(target: Computer, layout: Layout) -> _Frame:
    """The measures: the names of all contacts have room on the board."""
    lines = 1 + int(max(max(places_of(layout, side), default=0) for side in ("left", "right")))
    pitch = _PITCH if lines <= _MANY else _NARROW_PITCH
    names = [_contact_name(target, contact) for row in layout.rows for contact in row.contacts]
    column = max(COLUMN * contact.inner for row in layout.rows for contact in row.contacts)
    wide = 8 + max(width(name, 11) for name in names)
    longest = max(len(places_of(layout, edge)) for edge in ("top", "bottom"))
    inside = max(_INSIDE, 32 + column + wide, longest * wide / 2 + 10)
    top, bottom = (edge_room(layout, edge) for edge in ("top", "bottom"))
    return _Frame(inside, pitch, lines, -_HEAD - top, lines * pitch + 11 + bottom, wide)


def _board(picture: Picture, layout: Layout, frame: _Frame, summary: str, title: str, lanes: float) -> None:
    """Draws the board without its contacts, and the titles above it and above the ``lanes`` of wires."""
    picture.box(-frame.inside, frame.top, 2 * frame.inside, frame.bottom - frame.top, "board", round=8)
    if layout.top:
        wide = width(layout.top, 12) + 20
        picture.box(-wide / 2, -_HEAD - 8, wide, 26, "box")
        picture.text(0, -_HEAD + 9, layout.top, "middle")
    above = min(frame.top, lanes)
    picture.text(0, above - 38, title, "middle", 15, "bold")
    told = summary if layout.to_scale else f"{summary}, not to scale"
    picture.text(0, above - 18, told, "middle", 12, "bold")


def _contact_name(target: Computer, contact: Contact) -> str:
    """The name of a contact; that of a pin is followed by the names on the board."""
    if not contact.pin:
        return contact.name
    return " ".join(filter(None, (target.board.pin_title(contact.pin), printed_names(target, contact.pin))))


def _pads(
    target: Computer,
    layout: Layout,
    side: str,
    found: Sequence[Terminal],
    choice: PinChoice | None,
    wrong: Collection[ClaimSignal],
) -> list[_Pad]:
    """The contacts of a side.  ``found`` are its terminals."""
    options = {option.pin: option for option in choice.options} if choice is not None else {}
    users: dict[float, list[Terminal]] = {}
    for terminal in found:
        users.setdefault(terminal.place, []).append(terminal)
    mistaken = {terminal.place for terminal in found if (terminal.component, terminal.signal) in wrong}
    return [
        _Pad(target, layout, place, contact, users.get(place, []), options.get(contact.pin), place in mistaken)
        for place, contact in places_of(layout, side).items()
    ]


def _contacts(side: _Side, pads: Sequence[_Pad]) -> None:
    """Draws the contacts of a side, with their numbers and names."""
    picture, frame, sign = side.picture, side.frame, side.sign
    for pad in pads:
        x, y = side.place(pad.contact, pad.place)
        _contact(picture, x, y, pad.state, pad.title, pad.users[0].colour if pad.users else 0)
        if pad.option is not None and pad.option.state == "current":
            picture.box(x - 9, y - 7, 18, 14, "chosen", round=3)
        x, y = sign * (frame.inside - (COLUMN if pad.contact.pair else 0)), pad.place * frame.pitch
        if pad.contact.number is not None:
            picture.text(x - sign * 12, y + 4, str(pad.contact.number), side.inward, _SMALL, "faint")
        picture.text(x - sign * 34, y + 4, _contact_name(pad.target, pad.contact), side.inward, 11, pad.weight)
        if side.for_page and pad.contact.pin:
            left = -frame.inside - 10 if sign < 0 else 4.0
            data = {"pin": pad.target.board.pin_title(pad.contact.pin)}
            picture.hit(left, y - frame.pitch / 2, frame.inside + 6, frame.pitch, data, pad.title)


def _edge_contacts(picture: Picture, layout: Layout, edge: Edge, pads: Sequence[_Pad], for_page: bool) -> None:
    """Draws the contacts of an edge, with their numbers and names."""
    names = edge.y - edge.sign * (edge.depth + 16) + 4
    for pad in pads:
        (x, y), own = edge.pad(pad.place), edge.x(pad.place)
        _contact(picture, x, y, pad.state, pad.title, pad.users[0].colour if pad.users else 0)
        if pad.option is not None and pad.option.state == "current":
            picture.box(x - 9, y - 7, 18, 14, "chosen", round=3)
        if pad.contact.number is not None:
            picture.text(own, names, str(pad.contact.number), "middle", _SMALL, "faint")
        picture.text(own, names - edge.sign * 13, _contact_name(pad.target, pad.contact), "middle", 11, pad.weight)
        if for_page and pad.contact.pin:
            data = {"pin": pad.target.board.pin_title(pad.contact.pin)}
            top = edge.y - 8 if edge.sign < 0 else names - 26
            picture.hit(own - edge.wide / 2, top, edge.wide, edge.depth + 42, data, pad.title)
    first = 0
    for row in layout.rows:
        if row.side == edge.name:
            middle = edge.x(first + (len(row.contacts) - 1) / 2)
            picture.text(middle, names - edge.sign * 27, row.title, "middle", 11, "bold")
            first += len(row.contacts) + 2


def _row_titles(side: _Side) -> None:
    line = 0
    for row in side.layout.rows:
        if row.side == side.name:
            x, y = side.sign * (side.frame.inside - 12), line * side.frame.pitch - 12
            side.picture.text(x, y, row.title, side.inward, 11, "bold")
            line += len(row.contacts) + 2


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


@dataclass(frozen=True)
class _Columns:
    """The distances from the middle of the board to the first lane and to the components; the width of these."""

    near: float
    edge: float
    wide: float


def _soldered(side: _Side, parts: Sequence[_Part]) -> None:
    """Draws the components of a side, and their wires."""
    if not parts:
        return
    frame = side.frame
    told: dict[float, list[str]] = {}
    for terminal in (each for part in parts for each in part.terminals):
        told.setdefault(terminal.place, []).append(f"{terminal.component} {terminal.signal}")
    labels = {place: ", ".join(texts) for place, texts in told.items()}
    columns = _columns(frame, parts, max(width(label, _SMALL) for label in labels.values()))
    grounds = _grounds([p for p, contact in side.places.items() if side.layout.role(contact) == "ground"], parts)
    last = int(max(places_of(side.layout, side.name), default=frame.lines - 1))
    wires: list[_Wire] = []
    for part, first, ground in zip(parts, _lines(parts, last, frame), grounds, strict=True):
        _component(side, part, first, columns)
        wires += _wires_of(part, first, ground, frame.pitch, labels)
    _wires(side, columns, wires)
    for wire in wires if side.for_page else ():
        if wire.label:
            left = frame.inside + 14 if side.sign > 0 else -columns.near
            y, wide = wire.place * frame.pitch - 14, columns.near - frame.inside - 14
            side.picture.hit(left, y, wide, 18, {"signal": wire.signal}, wire.title)


def _columns(frame: _Frame, parts: Sequence[_Part], labels: float) -> _Columns:
    """The columns beside a board with room for the ``labels`` of the wires, a lane per wire, and all names."""
    near = frame.inside + 14 + labels + 10
    edge = near + sum(part.rows for part in parts) * _LANE + 10
    names = [max(width(part.component.name), width(part.kind, _SMALL)) for part in parts]
    return _Columns(near, edge, 24 + max(*names, width(_RESISTOR, _SMALL)))


def _component(side: _Side, part: _Part, first: int, columns: _Columns) -> None:
    """Draws a component whose first terminal is below the line ``first`` of the grid."""
    picture, pitch, wide, anchor = side.picture, side.frame.pitch, columns.wide, side.outward
    driven = drives(part.component)
    top, high = first * pitch - 32, part.rows * pitch + (54 if driven else 38)
    x = columns.edge if side.sign > 0 else -columns.edge - wide
    tx = x + 12 if side.sign > 0 else x + wide - 12
    picture.box(x, top, wide, high, "box", part.component.kind.summary)
    picture.text(tx, top + 15, part.component.name, anchor, 12, f"bold t{part.colour}")
    picture.text(tx, top + 29, part.kind, anchor, _SMALL, "faint")
    for index, terminal in enumerate(part.terminals):
        y = (first + index + 0.5) * pitch
        picture.text(tx, y + 4, terminal.signal, anchor, 11)
        if side.for_page:
            data = {"signal": f"{terminal.component}.{terminal.signal}"}
            title = f"{terminal.component} {terminal.signal}: {terminal.contact.name}"
            picture.hit(x, y - pitch / 2, wide, pitch, data, title)
    picture.text(tx, (first + part.rows - 0.5) * pitch + 4, "GND", anchor, 11)
    if driven:
        picture.text(tx, top + high - 9, _RESISTOR, anchor, _SMALL, "faint")


def _wires_of(part: _Part, first: int, ground: float | None, pitch: float, labels: dict[float, str]) -> list[_Wire]:
    """The wires of a component.  The first one of a contact takes its label, which is that of all, from ``labels``."""
    wires = []
    for index, terminal in enumerate(part.terminals):
        title = f"{terminal.component} {terminal.signal}" + (f": {terminal.resource}" if terminal.resource else "")
        y, label = (first + index + 0.5) * pitch, labels.pop(terminal.place, "")
        signal = f"{terminal.component}.{terminal.signal}"
        wires.append(_Wire(terminal.place, y, label, title, f"w{part.colour}", signal))
    if ground is not None:
        y = (first + part.rows - 0.5) * pitch
        wires.append(_Wire(ground, y, "", f"ground of {part.component.name}", "earth"))
    return wires


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


def _grounds(grounds: Sequence[float], parts: Sequence[_Part]) -> list[float | None]:
    """The ground contact of each component, as a line of the grid; None if the side has none.

    If there are enough ground contacts, each component gets a different one, from the top down.  If not, each component
    gets the nearest one.
    """
    result: list[float | None] = []
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
    """A wire from the contact at line ``place`` of the grid to the terminal at height ``y``, in pixels.

    ``signal`` is empty for the ground.
    """

    place: float
    y: float
    label: str
    title: str
    style: str
    signal: str = ""


def _wires(side: _Side, columns: _Columns, wires: Sequence[_Wire]) -> None:
    """Draws the wires, with lanes in the order in which the fewest wires cross.

    Wires that go down have the inner lanes, the lowest contact first.  Wires that go up have the outer lanes, the
    topmost contact first.
    """
    inside, pitch, sign = side.frame.inside, side.frame.pitch, side.sign
    contacts = side.places
    down = sorted((wire for wire in wires if wire.y > wire.place * pitch), key=lambda wire: (-wire.place, -wire.y))
    up = sorted((wire for wire in wires if wire.y <= wire.place * pitch), key=lambda wire: (wire.place, wire.y))
    size, above = (_SMALL, 5) if pitch == _PITCH else (9.5, 4)
    for lane, wire in enumerate([*down, *up]):
        second = wire.signal and not wire.label  # at a contact that another wire uses, too
        x, y = sign * (columns.near + lane * _LANE), wire.place * pitch + (4 if second else 0)
        points = [(sign * (inside + 5), y), (x, y), (x, wire.y), (sign * columns.edge, wire.y)]
        contact = contacts[wire.place]
        if wire.place in side.detours:
            points[:1] = side.detours[wire.place].points(y)
        elif contact.inner:  # the wire passes the other contact of the pair
            points[0] = side.place(contact, wire.place)[0], y
        elif contact.pair:
            points[:1] = [(sign * (inside + 5), side.place(contact, wire.place)[1]), (sign * (inside + 10), y)]
        side.picture.line(points, wire.style, wire.title)
        style = wire.style.replace("w", "t")
        side.picture.text(sign * (inside + 12), y - above, wire.label, side.outward, size, style)


def _supplies(layout: Layout) -> dict[str, str]:
    """The contacts without a pin, with their numbers in each row of the board, such as "J1 3, 5; J2 1"."""
    numbers: dict[str, dict[str, list[int]]] = {}  # contact -> row -> numbers
    for contact in (contact for row in layout.rows for contact in row.contacts):
        if not contact.pin and contact.number is not None:
            numbers.setdefault(contact.name, {}).setdefault(contact.row, []).append(contact.number)
    return {
        name: "; ".join(f"{row} {', '.join(map(str, sorted(found)))}".strip() for row, found in rows.items())
        for name, rows in numbers.items()
    }


def _marks(layout: Layout, seen: Collection[str], choice: PinChoice | None) -> list[tuple[str, str]]:
    """The states of contacts and the supplies of the board, with their meanings.

    ``seen`` are the states that the picture shows.
    """
    marks = [(state, text) for state, text in _legend(choice) if state in seen or state in ("used", "contact")]
    if choice is not None:
        marks.remove(("contact", _FREE))
    for name, place in _supplies(layout).items():
        marks.append((layout.supplies[name].role, f"{name} ({place}): {layout.supplies[name].title}"))
    return marks


def _rules(layout: Layout, others: Sequence[str], *, driven: bool) -> list[str]:
    """The rules for all wires.  ``driven`` means that the board drives some of them."""
    rules = [*others, *layout.notes, "Seen from above. Dashed: grounds, which are all connected."]
    supplies = _supplies(layout).items()
    feeding = [f"{name} ({place})" for name, place in supplies if layout.supplies[name].feeds_components]
    if feeding:
        rules.append(f"VCC of encoders and other sensors: {' or '.join(feeding)}. Motors need a separate supply.")
    if driven:
        rules.append(f"{_RESISTOR}: from each wire of the component, which floats until the firmware runs.")
    return rules


def _notes(picture: Picture, marks: Sequence[tuple[str, str]], rules: Sequence[str]) -> None:
    """Writes the notes below the picture."""
    x = -max(width(text, 11) for text in [*(text for _, text in marks), *rules]) / 2
    y = picture.bottom + 34
    for state, text in marks:
        _contact(picture, x - 12, y - 4, state)
        picture.text(x, y, text, size=11)
        y += 20
    for text in rules:
        picture.text(x, y, text, size=11, style="faint")
        y += 18


_FREE = "free pin"


def _legend(choice: PinChoice | None) -> list[tuple[str, str]]:
    """The states of contacts with a pin, and their meanings."""
    result = [
        ("used", "used: the colour is that of the wire"),
        ("wrong", "an error: see the messages"),
        ("contact", _FREE),
    ]
    if choice is not None:
        result += [("fits", f"can be {choice.title}"), ("unfit", f"cannot be {choice.title}")]
    return [*result, ("reserved", "reserved: used by the board itself, or by other code")]


def _told(target: Computer, contact: Contact) -> str:
    title = target.board.pin_title(contact.pin)
    return f"contact {contact.title} ({title})" if contact.title else title


def _description(
    target: Computer, layout: Layout, sides: Mapping[str, Sequence[Terminal]], others: Sequence[str]
) -> str:
    wires = [f"{t.component} {t.signal} to {_told(target, t.contact)}" for found in sides.values() for t in found]
    told = "; ".join([*wires, *others]) or "no wires"
    return f"{target.board.summary} seen from above, {layout.top} at the top: {told}."
