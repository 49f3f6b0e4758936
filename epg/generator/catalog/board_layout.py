# SPDX-License-Identifier: Apache-2.0
"""The places of the pins of a board, as rows of contacts.  Pictures of its wiring are drawn from them.

A board without such data gets rows that are made of the names of its pins, and that are not to scale.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from types import MappingProxyType

from epg.generator.dataclass import dataclass
from epg.generator.documents.items import flag_of, integer_of, map_of, text_of, texts_of, values_of
from epg.generator.source import YamlNode

_UNKNOWN = "The places of the contacts are not known: see the manual of the board."


@dataclass(frozen=True)
class Contact:
    """One contact of a row.  ``pin`` is the chip's name of the pin; empty for ground, supplies and other contacts.

    The pin can be one that is reserved, or wired to a device on the board, too.  ``number`` is None if it is not known.
    ``row`` is the title of its row.  ``pair`` is 1 for the first contact of a pair that is side by side, -1 for the
    second, 0 for all others; the ``inner`` one of a pair is farther from the edge of the board.
    """

    number: int | None
    name: str
    pin: str
    row: str = ""
    pair: int = 0
    inner: bool = False

    @property
    def title(self) -> str:
        """Its number on the board: ``36``, ``CN11 16``; empty if it is not known."""
        return "" if self.number is None else f"{self.row} {self.number}".strip()


@dataclass(frozen=True)
class ContactRow:
    """Contacts along the ``side`` of a board: "left" or "right" from the top down, "top" or "bottom" from the left."""

    side: str
    title: str
    contacts: tuple[Contact, ...]


@dataclass(frozen=True)
class Supply:
    """The description of contacts that are not pins: ``role`` is "ground", "supply" or "other".

    ``feeds_components`` is True for the supply of components whose signals have the levels of the pins.
    """

    role: str
    title: str
    feeds_components: bool = False


@dataclass(frozen=True)
class Layout:
    """The contacts of a board, seen from above.  ``top`` names the part of the board at its upper edge, or is empty."""

    top: str
    rows: tuple[ContactRow, ...]
    supplies: Mapping[str, Supply]
    notes: tuple[str, ...]  # notes that apply to all pins
    to_scale: bool = True

    def role(self, contact: Contact) -> str:
        """ "pin", or the role of a contact that is not a pin."""
        return "pin" if contact.pin else self.supplies[contact.name].role


def make_layout(node: YamlNode, pins: tuple[str, ...], others: Collection[str]) -> Layout | None:
    """The layout of a checked ``board.yaml``; without data, one that is made of ``pins``; None without pins.

    ``others`` are the pins that are reserved or wired to devices on the board.
    """
    layout = node.get("layout")
    if layout is None:
        return _made_of(pins) if pins else None
    rows = tuple(_row(child, {*pins, *others}) for child in layout["rows"].elements())
    supplies = {name: Supply(**values_of(child, Supply)) for name, child in map_of(layout, "supplies").items()}
    to_scale = "to_scale" not in layout or flag_of(layout, "to_scale")
    return Layout(text_of(layout, "top"), rows, MappingProxyType(supplies), texts_of(layout, "notes"), to_scale)


def _made_of(pins: tuple[str, ...]) -> Layout:
    """Rows with the pins of each port of the chip, half of them on each side."""
    ports: dict[str, list[Contact]] = {}
    for pin in pins:
        ports.setdefault(pin.rstrip("0123456789"), []).append(Contact(None, pin, pin))
    if len(ports) == 1:
        (whole,) = ports.values()
        half = (len(whole) + 1) // 2
        rows = [ContactRow("left", "", tuple(whole[:half])), ContactRow("right", "", tuple(whole[half:]))]
        return Layout("", tuple(row for row in rows if row.contacts), MappingProxyType({}), (_UNKNOWN,), False)
    made: list[ContactRow] = []
    for port, found in sorted(ports.items()):
        left = sum(len(row.contacts) for row in made) < len(pins) / 2
        made.append(ContactRow("left" if left else "right", port or "pins", tuple(found)))
    return Layout("", tuple(made), MappingProxyType({}), (_UNKNOWN,), False)


def _row(node: YamlNode, pins: Collection[str]) -> ContactRow:
    first, step = _whole(node["first"]), _whole(node["step"]) if "step" in node else 1
    names = [str(child.value) for child in node["contacts"].elements()]
    side, title = text_of(node, "side"), text_of(node, "title")
    paired = integer_of(node, "columns") == 2
    contacts = []
    for index, name in enumerate(names):
        pair = (1, -1)[index % 2] if paired else 0
        inner = pair == (1 if side in ("right", "bottom") else -1)  # a pair begins at the left, or at the top
        contacts.append(Contact(first + index * step, name, name if name in pins else "", title, pair, inner))
    return ContactRow(side, title, tuple(contacts))


def _whole(node: YamlNode) -> int:
    return node.value if isinstance(node.value, int) else 0
