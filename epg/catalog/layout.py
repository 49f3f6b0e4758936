# SPDX-License-Identifier: Apache-2.0
"""The places of the pins of a board, as rows of contacts.  Pictures of its wiring are drawn from them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType

from epg.documents.items import map_of, text_of, texts_of, values_of
from epg.source import YamlNode


@dataclass(frozen=True)
class Contact:
    """One contact of a row.  ``pin`` is the chip's name of the pin; empty for ground, supplies and other contacts."""

    number: int
    name: str
    pin: str


@dataclass(frozen=True)
class Row:
    """Contacts along the ``side`` ("left" or "right") of a board, from the top down."""

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
    """The contacts of a board, seen from above.  ``top`` names the part of the board at its upper edge."""

    top: str
    rows: tuple[Row, ...]
    supplies: Mapping[str, Supply]
    notes: tuple[str, ...]  # notes that apply to all pins

    def role(self, contact: Contact) -> str:
        """ "pin", or the role of a contact that is not a pin."""
        return "pin" if contact.pin else self.supplies[contact.name].role


def make_layout(node: YamlNode, pins: tuple[str, ...]) -> Layout | None:
    """The layout in a checked ``board.yaml``; None if it has none."""
    layout = node.get("layout")
    if layout is None:
        return None
    rows = tuple(_row(child, pins) for child in layout["rows"].elements())
    supplies = {name: Supply(**values_of(child, Supply)) for name, child in map_of(layout, "supplies").items()}
    return Layout(text_of(layout, "top"), rows, MappingProxyType(supplies), texts_of(layout, "notes"))


def _row(node: YamlNode, pins: tuple[str, ...]) -> Row:
    first, step = _whole(node["first"]), _whole(node["step"]) if "step" in node else 1
    names = [str(child.value) for child in node["contacts"].elements()]
    contacts = tuple(
        Contact(first + index * step, name, name if name in pins else "") for index, name in enumerate(names)
    )
    return Row(text_of(node, "side"), text_of(node, "title"), contacts)


def _whole(node: YamlNode) -> int:
    return node.value if isinstance(node.value, int) else 0
