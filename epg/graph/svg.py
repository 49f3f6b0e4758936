# SPDX-License-Identifier: Apache-2.0
"""A small writer of SVG files with rectangles, lines and text.  The width of text is computed: nothing overlaps.

>>> picture = Picture("Pan", "One box.")
>>> picture.box(0, 0, 80, 24, "box")
>>> picture.text(40, 16, "pan", anchor="middle")
>>> picture.render().startswith('<svg xmlns="http://www.w3.org/2000/svg"')
True

All text is in a monospaced font.  In browsers, the characters of these fonts are at most 0.62 times the font size wide.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from xml.sax.saxutils import escape, quoteattr

CHARACTER = 0.62
"""The width of a character, divided by the font size."""

_MARGIN = 16
_COLOURS = (  # light mode, dark mode: colours after Okabe and Ito (2008), with a contrast of 4.5 to the background
    ("#0060a0", "#6cb8f0"),
    ("#b04a00", "#f0a060"),
    ("#007050", "#40c8a0"),
    ("#a03080", "#e890c8"),
    ("#706000", "#d8c840"),
    ("#5048c0", "#a8a0ff"),
    ("#a02020", "#ff8a80"),
    ("#006878", "#50c8d8"),
)
WIRES = len(_COLOURS)
"""The number of colours of wires, which are the CSS classes ``w0``, ``w1``, ..."""

_STYLE = """
text { font-family: ui-monospace, 'DejaVu Sans Mono', Menlo, Consolas, monospace; fill: #1f2328; }
.back { fill: #ffffff; }
.box { fill: #f6f8fa; stroke: #59636e; stroke-width: 1.2; }
.model { fill: #ddf4ff; stroke: #0969da; stroke-width: 1.6; }
.board { fill: #dafbe1; stroke: #1a7f37; stroke-width: 1.6; }
.plain { fill: none; stroke: #59636e; stroke-dasharray: 4 3; }
.contact { fill: #ffffff; stroke: #1f2328; stroke-width: 1.2; }
.used { stroke: #1f2328; stroke-width: 1.2; }
.ground { fill: #1f2328; stroke: #1f2328; }
.supply { fill: #d1242f; stroke: #1f2328; }
.other { fill: #bf8700; stroke: #1f2328; }
.sign { fill: none; stroke: #ffffff; stroke-width: 1.6; }
.reserved { fill: #59636e; stroke: #1f2328; }
.fits { fill: #ffffff; stroke: #1a7f37; stroke-width: 3; }
.unfit { fill: #ffffff; stroke: #818b98; stroke-width: 1.2; }
.cross { fill: none; stroke: #59636e; stroke-width: 1.4; }
.wrong { fill: none; stroke: #d1242f; stroke-width: 2.4; }
.chosen { fill: none; stroke: #0969da; stroke-width: 2; }
.hit { fill: transparent; cursor: pointer; touch-action: none; }
.over { stroke: #0969da; stroke-width: 2.4; }
.refused { stroke: #d1242f; stroke-width: 2.4; stroke-dasharray: 5 3; }
.line { fill: none; stroke: #1f2328; stroke-width: 1.4; }
.earth { fill: none; stroke: #1f2328; stroke-width: 1.6; stroke-dasharray: 6 3; }
.grid { fill: none; stroke: #d1d9e0; }
.faint { fill: #59636e; }
.bold { font-weight: bold; }
"""
_DARK = """
text { fill: #f0f6fc; }
.back { fill: #0d1117; }
.box { fill: #1a212b; stroke: #9198a1; }
.model { fill: #0c2d4a; stroke: #58a6ff; }
.board { fill: #0f2f1c; stroke: #3fb950; }
.plain { stroke: #9198a1; }
.contact { fill: #0d1117; stroke: #f0f6fc; }
.used { stroke: #f0f6fc; }
.ground { fill: #f0f6fc; stroke: #f0f6fc; }
.supply { fill: #ff7b72; stroke: #f0f6fc; }
.other { fill: #d29922; stroke: #f0f6fc; }
.sign { stroke: #0d1117; }
.reserved { fill: #9198a1; stroke: #f0f6fc; }
.fits { fill: #0d1117; stroke: #3fb950; }
.unfit { fill: #0d1117; stroke: #656c76; }
.cross { stroke: #9198a1; }
.wrong { stroke: #ff7b72; }
.chosen { stroke: #58a6ff; }
.line, .earth { stroke: #f0f6fc; }
.grid { stroke: #3d444d; }
.faint { fill: #9198a1; }
"""


def width(text: str, size: float = 12) -> float:
    """The largest width of ``text``, in pixels.  ``size`` is the font size in pixels."""
    return len(text) * CHARACTER * size


class Picture:
    """A picture with shapes at any positions, in pixels.  Its size is the size of its shapes, with a margin."""

    def __init__(self, title: str, description: str) -> None:
        self.title = title
        self.description = description
        self._shapes: list[str] = []
        self._left = self._top = float("inf")
        self._right = self._bottom = float("-inf")

    def box(self, x: float, y: float, wide: float, high: float, style: str, title: str = "", round: float = 4) -> None:
        """Adds a rectangle.  A browser shows ``title`` when the mouse pointer is over it."""
        self._reach(x, y, x + wide, y + high)
        place = f'x="{_n(x)}" y="{_n(y)}" width="{_n(wide)}" height="{_n(high)}" rx="{_n(round)}"'
        self._add("rect", place, style, title)

    def hit(self, x: float, y: float, wide: float, high: float, data: Mapping[str, str], title: str) -> None:
        """Adds a rectangle that cannot be seen, for a page that reacts to the pointer.  ``data`` names its meaning."""
        named = " ".join(f"data-{name}={quoteattr(value)}" for name, value in data.items())
        place = f'x="{_n(x)}" y="{_n(y)}" width="{_n(wide)}" height="{_n(high)}" {named}'
        self._add("rect", place, "hit", title)

    def line(self, points: Sequence[tuple[float, float]], style: str = "line", title: str = "") -> None:
        """Adds a line through ``points``."""
        for x, y in points:
            self._reach(x, y, x, y)
        path = " ".join(f"{_n(x)},{_n(y)}" for x, y in points)
        self._add("polyline", f'points="{path}"', style, title)

    def arrow(self, points: Sequence[tuple[float, float]], style: str = "line", title: str = "") -> None:
        """Adds a line with an arrow head at its end.  Its last part must be horizontal or vertical."""
        self.line(points, style, title)
        (x0, y0), (x, y) = points[-2:]
        dx, dy = (x > x0) - (x < x0), (y > y0) - (y < y0)
        wings = [(x - 6 * dx - 3.5 * dy, y - 6 * dy - 3.5 * dx), (x, y), (x - 6 * dx + 3.5 * dy, y - 6 * dy + 3.5 * dx)]
        self.line(wings, style.replace("earth", "line"))

    def text(self, x: float, y: float, text: str, anchor: str = "start", size: float = 12, style: str = "") -> None:
        """Adds ``text`` with its base line at ``y``.  ``anchor`` is the part of it at ``x``: start, middle or end."""
        if not text:
            return
        wide = width(text, size)
        left = x - {"start": 0, "middle": wide / 2, "end": wide}[anchor]
        self._reach(left, y - size, left + wide, y + 0.3 * size)
        attributes = f' class="{style}"' if style else ""
        attributes += f' text-anchor="{anchor}"' if anchor != "start" else ""
        self._shapes.append(f'<text x="{_n(x)}" y="{_n(y)}" font-size="{_n(size)}"{attributes}>{escape(text)}</text>')

    def render(self) -> str:
        """The text of the SVG file."""
        x, y = self._left - _MARGIN, self._top - _MARGIN
        wide, high = self._right - x + _MARGIN, self._bottom - y + _MARGIN
        lines = [
            f'<svg xmlns="http://www.w3.org/2000/svg" width="{_n(wide)}" height="{_n(high)}" '
            f'viewBox="{_n(x)} {_n(y)} {_n(wide)} {_n(high)}" role="img" aria-labelledby="title description">',
            f'<title id="title">{escape(self.title)}</title>',
            f'<desc id="description">{escape(self.description)}</desc>',
            f"<style>{style_sheet(landscape=wide > high)}</style>",
            f'<rect x="{_n(x)}" y="{_n(y)}" width="{_n(wide)}" height="{_n(high)}" class="back"/>',
            *self._shapes,
            "</svg>",
        ]
        return "\n".join(lines) + "\n"

    @property
    def bottom(self) -> float:
        """The lowest edge of the shapes that were added so far."""
        return self._bottom

    def _add(self, tag: str, place: str, style: str, title: str) -> None:
        inside = f"><title>{escape(title)}</title></{tag}>" if title else "/>"
        self._shapes.append(f'<{tag} {place} class="{style}"{inside}')

    def _reach(self, left: float, top: float, right: float, bottom: float) -> None:
        self._left, self._top = min(self._left, left), min(self._top, top)
        self._right, self._bottom = max(self._right, right), max(self._bottom, bottom)


def style_sheet(*, landscape: bool) -> str:
    """The text of ``<style>``.  A picture that is printed fills one page, in portrait or ``landscape``.

    There are only these two texts, so that the content security policy of a page can allow them by their hashes.
    """
    style, dark = _STYLE, _DARK
    for index, (light, night) in enumerate(_COLOURS):
        style += f".w{index} {{ fill: none; stroke: {light}; stroke-width: 2.2; }}\n.t{index} {{ fill: {light}; }}\n"
        dark += f".w{index} {{ stroke: {night}; }}\n.t{index} {{ fill: {night}; }}\n"
    page = f"@page {{ size: A4 {'landscape' if landscape else 'portrait'}; margin: 10mm; }}\n"
    page += "@media print { svg { width: 100vw; height: 100vh; } }\n"
    return f"{style}@media screen and (prefers-color-scheme: dark) {{{dark}}}\n{page}"


def _n(value: float) -> str:
    """A coordinate with at most one decimal, so that the text is the same on every computer."""
    return f"{value:.1f}".removesuffix(".0")
