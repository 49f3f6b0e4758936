# SPDX-License-Identifier: Apache-2.0
"""Draws a system: its targets below each other, and a line for each topic that one target sends to others.

A line leaves its sender to the right, goes up or down in a separate lane, and has an arrow at each receiver.  Inputs
from other programs come from the left.  The plant of the system is on the left of all, with a line to each target.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import field

from epg.generator.dataclass import dataclass
from epg.generator.quantity import show
from epg.generator.resolve.application import Plant
from epg.graph.svg import WIRES, Picture, width
from epg.system.check_system import CheckedSystem, Link
from epg.system.system import End

_ROW = 20.0
_HEAD = 40.0  # the height of the name and the board of a target
_BETWEEN = 18.0  # the distance of two targets
_LANE = 14.0
_WORLD = 90.0  # the length of the arrows of the world


@dataclass
class _Target:
    """A target as a box: the rows of its ports from the top, and the position of each row."""

    name: str
    facts: str
    top: float
    rows: list[tuple[str, str]] = field(default_factory=list)  # text on the left, text on the right

    @property
    def height(self) -> float:
        return _HEAD + len(self.rows) * _ROW + 4

    def y(self, row: int) -> float:
        return self.top + _HEAD + row * _ROW + _ROW / 2

    def add(self, left: str, right: str) -> int:
        """The number of a new row with these texts."""
        self.rows.append((left, right))
        return len(self.rows) - 1


@dataclass(frozen=True)
class _Line:
    """A topic: the row of its sender, and the rows of its receivers."""

    sender: tuple[str, int]
    receivers: tuple[tuple[str, int], ...]
    label: str
    title: str


def draw_system(checked: CheckedSystem) -> str:
    """The picture as the text of an SVG file."""
    targets = {
        name: _Target(name, f"{app.target.name}, {show(app.period, 'time')}", 0.0)
        for name, app in checked.applications.items()
    }
    world = [(end, targets[end.target].add(end.port, "")) for end in checked.system.world]
    lines = _lines(checked.links, targets)
    top = 0.0
    for target in targets.values():
        target.top = top
        top += target.height + _BETWEEN
    wide = max(_width(target) for target in targets.values())
    labels = max((width(line.label, 10) for line in lines), default=0.0) + 12
    picture = Picture(f"{checked.system.name}: the system", _description(checked))
    picture.text(wide / 2, -20, checked.system.name, "middle", 15, "bold")
    for target in targets.values():
        _draw_target(picture, target, wide)
    for number, line in enumerate(lines):
        _draw_line(picture, line, targets, wide, wide + labels + number * _LANE, number % WIRES)
    if checked.plant is not None:
        wires = checked.plant_wires
        _draw_plant(picture, checked.plant, wires, list(targets.values()), _WORLD if world else 0.0)
    for end, row in world:
        y = targets[end.target].y(row)
        picture.arrow([(-_WORLD, y), (0, y)], "line", f"{end}: from other programs")
        picture.text(-_WORLD, y - 5, end.topic or "world", "start", 10, "faint")
    return picture.render()


def _lines(links: Sequence[Link], targets: dict[str, _Target]) -> list[_Line]:
    """One line for each topic, with a row at each of its ends."""
    topics: dict[tuple[str, str], list[Link]] = {}
    for link in links:
        topics.setdefault((link.connection.sender.target, link.connection.sender.component), []).append(link)
    lines = []
    rows: dict[tuple[str, str, bool], int] = {}
    for several in topics.values():
        first = several[0]
        sender = _row(first.connection.sender, False, targets, rows)
        receivers = [_row(link.connection.receiver, True, targets, rows) for link in several]
        label = ", ".join(text for text in (first.unit, first.sent) if text)
        title = f"{first.connection.sender}: {first.message}"
        lines.append(_Line(sender, tuple(dict.fromkeys(receivers)), label, title))
    return lines


def _row(
    end: End, receives: bool, targets: dict[str, _Target], rows: dict[tuple[str, str, bool], int]
) -> tuple[str, int]:
    """The row of a topic component.  Several values of one message share a row."""
    key = (end.target, end.component, receives)
    if key not in rows:
        rows[key] = targets[end.target].add("", end.component)
    return end.target, rows[key]


def _width(target: _Target) -> float:
    rows = [width(left, 11) + width(right, 11) + 24 for left, right in target.rows]
    return max(width(target.name, 13), width(target.facts, 10), *rows, 0.0) + 24


def _draw_target(picture: Picture, target: _Target, wide: float) -> None:
    picture.box(0, target.top, wide, target.height, "board", target.facts)
    picture.text(wide / 2, target.top + 17, target.name, "middle", 13, "bold")
    picture.text(wide / 2, target.top + 31, target.facts, "middle", 10, "faint")
    for row, (left, right) in enumerate(target.rows):
        picture.text(10, target.y(row) + 4, left, "start", 11)
        picture.text(wide - 10, target.y(row) + 4, right, "end", 11)


def _draw_line(
    picture: Picture, line: _Line, targets: dict[str, _Target], edge: float, lane: float, colour: int
) -> None:
    style = f"w{colour}"
    name, row = line.sender
    y = targets[name].y(row)
    picture.text(edge + 6, y - 4, line.label, "start", 10, f"t{colour}")
    for receiver, at in line.receivers:
        end = targets[receiver].y(at)
        picture.arrow([(edge, y), (lane, y), (lane, end), (edge, end)], style, f"{line.title} to {receiver}")


def _draw_plant(
    picture: Picture, plant: Plant, wires: Mapping[str, int], targets: Sequence[_Target], world: float
) -> None:
    """Draws the plant.  ``world`` is the room for inputs from other programs between it and the targets."""
    facts = f"simulated, {show(plant.model.step, 'time')}"
    wide = max(width(plant.model.name, 13), width("plant", 11), width(facts, 10)) + 24
    right = -world - 30 - max((width(_wires(count), 10) for count in wires.values()), default=0.0)
    bottom = targets[-1].top + targets[-1].height
    picture.box(right - wide, 0, wide, bottom, "model")
    for down, text, size, style in (
        (17.0, plant.model.name, 13, "bold"),
        (31.0, "plant", 11, ""),
        (45.0, facts, 10, "faint"),
    ):
        picture.text(right - wide / 2, down, text, "middle", size, style)
    for target in targets:
        if target.name in wires:
            y = target.top + 20
            picture.line([(right, y), (0, y)], "earth", f"{target.name} senses and moves {plant.model.name}")
            picture.text(right + 6, y - 5, _wires(wires[target.name]), "start", 10, "faint")


def _wires(count: int) -> str:
    return f"{count} wire{'' if count == 1 else 's'}"


def _description(checked: CheckedSystem) -> str:
    links = [f"{link.connection.sender} to {link.connection.receiver}" for link in checked.links]
    sends = [f"other programs to {end}" for end in checked.system.world]
    plant = f" The plant {checked.plant.model.name}." if checked.plant is not None else ""
    return f"The targets {', '.join(checked.applications)}.{plant} " + "; ".join([*links, *sends]) + "."
