# SPDX-License-Identifier: Apache-2.0
"""The contacts at the upper and lower edge of a board, in the drawing of its wiring.

Their components are beside the board, too.  A wire goes away from the board, and then above or below it to the left or
right side, whichever is nearer.  From there it is drawn as all wires of this side: its line is a fraction.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace

from epg.generator.catalog.board_layout import Contact, Layout
from epg.generator.dataclass import dataclass
from epg.graph.terminals import Terminal, places_of

COLUMN = 16.0  # between the two contacts of a pair
_LANE = 16.0
_FIRST_LANE = 16.0


@dataclass(frozen=True)
class Edge:
    """The edge ``name`` of a board, "top" or "bottom", at the height ``y``, with ``wide`` pixels per contact."""

    name: str
    contacts: Mapping[float, Contact]
    wide: float
    y: float

    @property
    def sign(self) -> int:
        """The direction away from the board."""
        return -1 if self.name == "top" else 1

    @property
    def depth(self) -> float:
        """The height of the contacts, without their names."""
        return COLUMN * any(contact.inner for contact in self.contacts.values())

    def x(self, place: float) -> float:
        return (place - max(self.contacts) / 2) * self.wide

    def pad(self, place: float) -> tuple[float, float]:
        """The middle of a contact.  Those of a pair are one above the other, between the places of their wires."""
        contact = self.contacts[place]
        return self.x(place + contact.pair / 2), self.y - self.sign * COLUMN * contact.inner


@dataclass(frozen=True)
class Detour:
    """The way of a wire from the contact at ``place`` of an edge to its height outside of the board."""

    edge: Edge
    place: float
    y: float

    @property
    def contact(self) -> Contact:
        return self.edge.contacts[self.place]

    def points(self, y: float) -> list[tuple[float, float]]:
        """The points up to the height ``y``."""
        (x, start), own = self.edge.pad(self.place), self.edge.x(self.place)
        if not self.contact.pair:
            return [(x, start + 5 * self.edge.sign), (x, y)]
        bend = start if self.contact.inner else start + 10 * self.edge.sign
        return [(x, start), (own, bend), (own, y)]


def edge_room(layout: Layout, name: str) -> float:
    """The height that the contacts of an edge and their names take inside of the board; 0 without contacts."""
    edge = Edge(name, places_of(layout, name), 0, 0)
    titled = any(row.title for row in layout.rows if row.side == name)
    return 40 + edge.depth + 18 * titled if edge.contacts else 0


def detours_of(
    layout: Layout, edges: Collection[Edge], sides: Mapping[str, Sequence[Terminal]]
) -> dict[str, list[Detour]]:
    """The detours of the contacts that are used, and of grounds, to the "left" and to the "right"."""
    result: dict[str, list[Detour]] = {"left": [], "right": []}
    for edge in edges:
        used = {terminal.place for terminal in sides[edge.name] if not terminal.on_board}
        grounds = {place for place, contact in edge.contacts.items() if layout.role(contact) == "ground"}
        wired = sorted(used | grounds, key=lambda place: -abs(edge.x(place)))  # the outer ones have the inner lanes
        for name, found in result.items():
            own = [place for place in wired if (edge.x(place) < 0) == (name == "left")]
            found += [
                Detour(edge, place, edge.y + edge.sign * (_FIRST_LANE + _LANE * lane)) for lane, place in enumerate(own)
            ]
    return result


def highest(detours: Mapping[str, Sequence[Detour]]) -> float:
    """The height of the uppermost detour, or that of the first line of the grid."""
    return min((detour.y for ways in detours.values() for detour in ways), default=0)


def moved(
    side: str, detours: Sequence[Detour], sides: Mapping[str, Sequence[Terminal]], pitch: float
) -> list[Terminal]:
    """The soldered terminals at ``side``, and those at edges whose wires take ``detours`` to it.

    The place of these is the line of the grid at which the detour ends.
    """
    by_edge = [
        replace(terminal, place=detour.y / pitch)
        for detour in detours
        for terminal in sides[detour.edge.name]
        if terminal.place == detour.place
    ]
    return [terminal for terminal in [*sides[side], *by_edge] if not terminal.on_board]
