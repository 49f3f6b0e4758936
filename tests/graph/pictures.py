# SPDX-License-Identifier: Apache-2.0
"""The contents of an SVG of EPG: texts with the space that they need, and lines."""

from __future__ import annotations

import xml.etree.ElementTree as ElementTree
from dataclasses import dataclass

from epg.graph.svg import CHARACTER

_SVG = "{http://www.w3.org/2000/svg}"
Point = tuple[float, float]


@dataclass(frozen=True)
class Text:
    text: str
    left: float
    top: float
    right: float
    bottom: float
    style: str

    def overlaps(self, other: Text) -> bool:
        return (
            min(self.right, other.right) - max(self.left, other.left) > 0.05
            and min(self.bottom, other.bottom) - max(self.top, other.top) > 0.05
        )


@dataclass(frozen=True)
class Line:
    points: tuple[Point, ...]
    style: str
    title: str

    @property
    def parts(self) -> list[tuple[Point, Point]]:
        return list(zip(self.points, self.points[1:], strict=False))


class Svg:
    def __init__(self, text: str) -> None:
        self.root = ElementTree.fromstring(text)
        self.texts = [_text(element) for element in self.root.iter(f"{_SVG}text")]
        self.lines = [_line(element) for element in self.root.iter(f"{_SVG}polyline")]
        self.box = [float(word) for word in self.root.attrib["viewBox"].split()]

    @property
    def words(self) -> list[str]:
        return [text.text for text in self.texts]

    def line(self, title: str) -> Line:
        """The only line with this title, which is shown under the pointer."""
        (found,) = (line for line in self.lines if line.title.partition(":")[0] == title)
        return found

    def overlaps(self) -> list[tuple[str, str]]:
        """Pairs of texts that overlap."""
        return [
            (one.text, other.text)
            for index, one in enumerate(self.texts)
            for other in self.texts[index + 1 :]
            if one.overlaps(other)
        ]

    def outside(self) -> list[str]:
        """Texts that cross the edge of the picture."""
        left, top, wide, high = self.box
        return [
            t.text for t in self.texts if t.left < left or t.top < top or t.right > left + wide or t.bottom > top + high
        ]


def _text(element: ElementTree.Element) -> Text:
    x, y, size = (float(element.attrib[name]) for name in ("x", "y", "font-size"))
    text = element.text or ""
    wide = CHARACTER * size * len(text)
    left = x - {"start": 0.0, "middle": wide / 2, "end": wide}[element.attrib.get("text-anchor", "start")]
    # from the top of capitals to the end of descenders
    return Text(text, left, y - 0.76 * size, left + wide, y + 0.24 * size, element.attrib.get("class", ""))


def _line(element: ElementTree.Element) -> Line:
    points = tuple(tuple(map(float, word.split(","))) for word in element.attrib["points"].split())
    title = element.find(f"{_SVG}title")
    return Line(points, element.attrib["class"], title.text or "" if title is not None else "")  # type: ignore[arg-type]
