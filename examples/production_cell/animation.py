# SPDX-License-Identifier: Apache-2.0
"""Draws two rounds of the production cell as an animated SVG, from the trace of a simulation.

    build/production_cell --duration 60 --trace trace
    python animation.py trace docs/pictures/production-cell.svg

A round is the time between two blocks that leave the mould.  After two rounds, each block is where another one was at
first.  Blocks look alike, so that the picture repeats without a jump.
"""

from __future__ import annotations

import csv
import math
import sys
from collections.abc import Callable, Sequence
from itertools import pairwise
from pathlib import Path

Row = dict[str, float]
Point = tuple[float, ...]

FIRST, ROUNDS = 4, 2  # the number of the block with which the picture begins: the line is in its rhythm then
SAMPLE = 0.02  # s
TOLERANCE = 0.4  # pixels between the trace and the picture
SCALE, LEFT, TOP = 800.0, 0.36, 0.6  # pixels/m; m at the left edge and at the top
WIDTH, HEIGHT = 880, 630
BLOCK = 0.04  # m

BELT, FEEDER, DOOR, EXTRACTOR, ROBOT = "#5b6b7b", "#1f77b4", "#8c4bb8", "#2a8f4f", "#c2410c"
MACHINES = (  # name, board, place of the text in m, colour
    ("feeder belt", "Pico, FreeRTOS", (0.235, 0.468), BELT),
    ("feeder", "Pico, bare metal", (0.61, 0.47), FEEDER),
    ("mould, door", "Nucleo, FreeRTOS", (0.64, 0.285), DOOR),
    ("extractor", "any firmware", (0.61, 0.1), EXTRACTOR),
    ("extraction belt", "Pico, Zephyr", (0.235, -0.082), BELT),
    ("rotation robot", "Pico 2, FreeRTOS", (0.13, 0.195), ROBOT),
)
BARRIERS = (  # output of the plant, place in m
    ("feeder_belt_start", (0.025, 0.433)),
    ("feeder_belt_end", (0.467, 0.433)),
    ("mould", (0.542, 0.25)),
    ("extraction_belt_start", (0.475, -0.033)),
    ("extraction_belt_end", (0.033, -0.033)),
)
SPACES = (  # file and column of the guest's state, centre and size in m, colour of the guest
    ("feeder", "outputs.belt_state", (0.5, 0.4), (0.075, 0.075), FEEDER),
    ("feeder", "outputs.mould_state", (0.5, 0.27), (0.075, 0.1), FEEDER),
    ("extractor", "outputs.source_state", (0.5, 0.27), (0.075, 0.1), EXTRACTOR),
    ("extractor", "outputs.belt_state", (0.5, 0.0), (0.075, 0.075), EXTRACTOR),
    ("robot", "outputs.source_state", (0.0, 0.0), (0.075, 0.075), ROBOT),
    ("robot", "outputs.belt_state", (0.0, 0.4), (0.075, 0.075), ROBOT),
)
RADIUS = {"feeder_belt": 0.01, "feeder": 0.01, "door": 0.008, "extractor": 0.01, "extraction_belt": 0.01, "robot": 0.02}


def number(value: float) -> str:
    return f"{value:.1f}".rstrip("0").rstrip(".").replace("-0", "0" if abs(value) < 0.05 else "-0")


def pixel(x: float, y: float) -> tuple[float, float]:
    return (x + LEFT) * SCALE, (TOP - y) * SCALE


def load(file: Path) -> list[Row]:
    with file.open(newline="") as text:
        return [{key: float(value) for key, value in row.items() if value} for row in csv.DictReader(text)]


class Trace:
    """The rows of the files of a trace, at regular times of the picture."""

    def __init__(self, folder: Path) -> None:
        plant = load(folder / "plant.csv")
        ends = [row["time"] for before, row in pairwise(plant) if moulded(row) > moulded(before)]
        self.begin, end = ends[FIRST - 1], ends[FIRST - 1 + ROUNDS]
        self.duration = end - self.begin
        self.times = [
            self.begin + i * self.duration / round(self.duration / SAMPLE)
            for i in range(round(self.duration / SAMPLE) + 1)
        ]
        self.files = {name: self._sampled(load(folder / f"{name}.csv")) for name in ("feeder", "extractor", "robot")}
        self.files["plant"] = self._sampled(plant)

    def _sampled(self, rows: Sequence[Row]) -> list[Row]:
        found, at = [], 0
        for time in self.times:
            while at + 1 < len(rows) and rows[at + 1]["time"] <= time:
                at += 1
            found.append(rows[at])
        return found

    def of(self, name: str, function: Callable[[Row], Point]) -> list[Point]:
        return [function(row) for row in self.files[name]]


def moulded(row: Row) -> float:
    return row["outputs.moulded"]


def way(row: Row, axis: str) -> float:
    """The position of an axis, m."""
    return row[f"outputs.{axis}"] * RADIUS[axis]


def simplified(points: Sequence[Point]) -> list[int]:
    """The indices of the points between which straight lines describe all points (Ramer, Douglas, Peucker)."""
    keep, spans = {0, len(points) - 1}, [(0, len(points) - 1)]
    while spans:
        first, last = spans.pop()
        worst, at = 0.0, first
        for i in range(first + 1, last):
            share = (i - first) / (last - first)
            between = [a + share * (b - a) for a, b in zip(points[first], points[last], strict=True)]
            distance = math.dist(points[i], between)
            if distance > worst:
                worst, at = distance, i
        if worst > TOLERANCE:
            keep.add(at)
            spans += [(first, at), (at, last)]
    return sorted(keep)


class Drawing:
    def __init__(self, trace: Trace) -> None:
        self.trace = trace
        self.lines: list[str] = []

    def add(self, *lines: str) -> None:
        self.lines += lines

    def _timing(self, indices: Sequence[int]) -> str:
        last = len(self.trace.times) - 1
        times = ";".join(f"{i / last:.4f}".rstrip("0").rstrip(".") for i in indices)
        return f'keyTimes="{times}" dur="{self.trace.duration:.2f}s" repeatCount="indefinite"'

    def motion(self, kind: str, points: Sequence[Point], centre: str = "") -> str:
        """The animation of a translation, or of a rotation about `centre`."""
        indices = simplified(points)
        values = ";".join(",".join(number(value) for value in points[i]) + centre for i in indices)
        return f'<animateTransform attributeName="transform" type="{kind}" values="{values}" {self._timing(indices)}/>'

    def value(self, attribute: str, points: Sequence[Point]) -> str:
        indices = simplified(points)
        values = ";".join(number(points[i][0]) for i in indices)
        return f'<animate attributeName="{attribute}" values="{values}" {self._timing(indices)}/>'

    def steps(self, attribute: str, states: Sequence[str]) -> str:
        """The animation of an attribute that jumps."""
        changes = [i for i in range(len(states)) if i == 0 or states[i] != states[i - 1]]
        values = ";".join(states[i] for i in changes)
        return f'<animate attributeName="{attribute}" calcMode="discrete" values="{values}" {self._timing(changes)}/>'

    def rectangle(self, centre: Point, size: Point, style: str, inside: str = "") -> str:
        x, y = pixel(centre[0] - size[0] / 2, centre[1] + size[1] / 2)
        shape = f'x="{number(x)}" y="{number(y)}" width="{number(size[0] * SCALE)}" height="{number(size[1] * SCALE)}"'
        return f"<rect {shape} {style}/>" if not inside else f"<rect {shape} {style}>{inside}</rect>"


def belt(drawing: Drawing, axis: str, y: float, right: bool) -> None:
    """A belt, with ribs that move with it."""
    drawing.add(drawing.rectangle((0.25, y), (0.58, 0.066), 'rx="26" fill="#e3e7eb" stroke="#9aa5b1" stroke-width="2"'))
    ways = drawing.trace.of("plant", lambda row: (way(row, axis),))
    moved = ways[-1][0] - ways[0][0]
    rib = moved / max(1, round(moved / 0.05)) if moved > 0.01 else 0.05  # a whole number of ribs passes in a round
    offsets = [((-1.0 if right else 1.0) * (position[0] - ways[0][0]) * SCALE,) for position in ways]
    (x1, height), (x2, _) = pixel(-0.025, y), pixel(0.525, y)
    dashes = f'stroke-dasharray="3 {rib * SCALE - 3:.2f}"'
    line = f'<line x1="{number(x1)}" y1="{number(height)}" x2="{number(x2)}" y2="{number(height)}" stroke="#c3ccd5"'
    drawing.add(f'{line} stroke-width="46" {dashes}>{drawing.value("stroke-dashoffset", offsets)}</line>')


def spaces(drawing: Drawing) -> None:
    for name, column, centre, size, colour in SPACES:
        inside = ["0.35" if row[column] < 0.5 else "0" for row in drawing.trace.files[name]]
        style = f'rx="8" fill="{colour}" fill-opacity="0"'
        drawing.add(drawing.rectangle(centre, size, style, drawing.steps("fill-opacity", inside)))
    for centre, size in sorted({(space[2], space[3]) for space in SPACES}):
        style = 'rx="8" fill="none" stroke="#475569" stroke-width="1.5" stroke-dasharray="5 4"'
        drawing.add(drawing.rectangle(centre, size, style))


def blocks(drawing: Drawing) -> None:
    for i in range(1, 5):
        points = drawing.trace.of("plant", lambda row, i=i: pixel(row[f"outputs.x{i}"], row[f"outputs.y{i}"]))
        half = BLOCK * SCALE / 2
        shape = f'x="{number(-half)}" y="{number(-half)}" width="{number(2 * half)}" height="{number(2 * half)}"'
        style = 'rx="4" fill="#f2b431" stroke="#a86f00" stroke-width="2"'
        drawing.add(f"<g><rect {shape} {style}/>{drawing.motion('translate', points)}</g>")


def machines(drawing: Drawing) -> None:
    trace = drawing.trace
    # The mould, and the door below it, which is drawn as if it slid to the right.
    x, y = pixel(0.5, 0.25)
    walls = "".join(f"M{number(x + side)} {number(y - 30)}V{number(y + 18)}" for side in (-34, 34))
    drawing.add(f'<path d="{walls}" stroke="#334155" stroke-width="7" stroke-linecap="round"/>')
    style = f'rx="3" fill="{DOOR}"'
    door = trace.of("plant", lambda row: ((0.085 - way(row, "door")) * SCALE, 0.0))
    drawing.add(f"<g>{drawing.rectangle((0.5, 0.222), (0.085, 0.012), style)}{drawing.motion('translate', door)}</g>")
    # The feeder above the mould, the extractor below it.
    feeder = trace.of("plant", lambda row: (0.0, way(row, "feeder") * SCALE))
    rod = drawing.rectangle((0.5, 0.56), (0.014, 0.2), f'fill="{FEEDER}"')
    plate = drawing.rectangle((0.5, 0.448), (0.05, 0.014), f'rx="3" fill="{FEEDER}"')
    drawing.add(f"<g>{rod}{plate}{drawing.motion('translate', feeder)}</g>")
    extractor = trace.of("plant", lambda row: (0.0, -way(row, "extractor") * SCALE))
    rod = drawing.rectangle((0.5, -0.15), (0.014, 0.3), f'fill="{EXTRACTOR}" fill-opacity="0.8"')
    drawing.add(f"<g>{rod}{magnet(pixel(0.5, 0.0), EXTRACTOR)}{drawing.motion('translate', extractor)}</g>")
    # The robot turns on the left side: at 0 its magnet is above the feeder belt.
    pivot, tip = pixel(0.0, 0.2), pixel(0.0, 0.4)
    turned = trace.of("plant", lambda row: (-math.degrees(way(row, "robot") / 0.2),))
    arm = (
        f'<line x1="{number(pivot[0])}" y1="{number(pivot[1])}" x2="{number(tip[0])}" y2="{number(tip[1])}" '
        f'stroke="{ROBOT}" stroke-opacity="0.85" stroke-width="11" stroke-linecap="round"/>'
    )
    about = f",{number(pivot[0])},{number(pivot[1])}"
    drawing.add(f"<g>{arm}{magnet(tip, ROBOT)}{drawing.motion('rotate', turned, about)}</g>")
    drawing.add(f'<circle cx="{number(pivot[0])}" cy="{number(pivot[1])}" r="17" fill="{ROBOT}"/>')


def magnet(centre: Point, colour: str) -> str:
    place = f'cx="{number(centre[0])}" cy="{number(centre[1])}"'
    return f'<circle {place} r="11" fill="#fff" fill-opacity="0.75" stroke="{colour}" stroke-width="5"/>'


def barriers(drawing: Drawing) -> None:
    for name, place in BARRIERS:
        states = ["#dc2626" if row[f"outputs.{name}"] > 0.5 else "#cbd5e1" for row in drawing.trace.files["plant"]]
        x, y = pixel(*place)
        style = 'r="5" stroke="#475569" stroke-width="1" fill="#cbd5e1"'
        drawing.add(f'<circle cx="{number(x)}" cy="{number(y)}" {style}>{drawing.steps("fill", states)}</circle>')


def text(place: Point, words: str, size: int, colour: str, more: str = "") -> str:
    at = f'x="{number(place[0])}" y="{number(place[1])}"'
    return f'<text {at} font-size="{size}" fill="{colour}"{more}>{words}</text>'


def texts(drawing: Drawing) -> None:
    bold, middle, grey = ' font-weight="bold"', ' text-anchor="middle"', "#475569"
    for name, board, place, colour in MACHINES:
        x, y = pixel(*place)
        drawing.add(text((x, y), name, 19, colour, bold + middle), text((x, y + 19), board, 14, grey, middle))
    drawing.add(text((24, 38), "Six microcontrollers pass blocks round", 23, "#0f172a", bold))
    y = HEIGHT - 22
    look = f'rx="5" fill="{ROBOT}" fill-opacity="0.35" stroke="{grey}" stroke-dasharray="5 4"'
    drawing.add(f'<rect x="24" y="{y - 15}" width="20" height="20" {look}/>')
    drawing.add(text((54, y), "this machine has the lease of the space; its neighbour waits", 15, grey))
    drawing.add(f'<circle cx="34" cy="{y - 30}" r="5" fill="#dc2626" stroke="{grey}"/>')
    drawing.add(text((54, y - 25), "a light barrier sees a block", 15, grey))


def picture(folder: Path) -> str:
    drawing = Drawing(Trace(folder))
    drawing.add(f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {HEIGHT}" font-family="sans-serif">')
    drawing.add("<title>Six machines pass blocks round: simulation of the production cell</title>")
    drawing.add(f'<rect width="{WIDTH}" height="{HEIGHT}" rx="14" fill="#f8fafc"/>')
    belt(drawing, "feeder_belt", 0.4, right=True)
    belt(drawing, "extraction_belt", 0.0, right=False)
    spaces(drawing)
    blocks(drawing)
    machines(drawing)
    barriers(drawing)
    texts(drawing)
    drawing.add("</svg>")
    return "\n".join(drawing.lines) + "\n"


if __name__ == "__main__":
    Path(sys.argv[2]).write_text(picture(Path(sys.argv[1])), encoding="utf-8")
