# SPDX-License-Identifier: Apache-2.0
"""What all plots have in common: colours, a size that stays bounded, marks of events, and files that are reproducible.

>>> arrange(3, 2.0)
Arrangement(shown=3, rows=3, columns=1)
>>> arrange(40, 2.0), arrange(1000, 2.0).shown
(Arrangement(shown=40, rows=14, columns=3), 56)
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any, NamedTuple, TypeAlias

# M. Okabe, K. Ito, "Color Universal Design", 2008: users with any common colour vision can distinguish these colours
BLACK, BLUE, ORANGE, GREEN, PURPLE, SKY, GREY = (
    "#000000",
    "#0072B2",
    "#D55E00",
    "#009E73",
    "#CC79A7",
    "#56B4E9",
    "#999999",
)

# Those of matplotlib, which is imported only to draw, and whose old versions have no types.
Axes: TypeAlias = Any
Figure: TypeAlias = Any

PICTURES = (".png", ".svg")
"""The endings of the files that :func:`save` can write."""

SMALL = 8.5
"""The size of legends and marks in points: still readable when a page shows the picture at 800 pixels."""

_HEIGHT, _WIDTH, _COLUMN, _COLUMNS = 17.0, 8.0, 5.5, 4
"""Inches: the greatest height of the panels; the width of a picture with one column and of each further column."""

_DOTS = 150  # per inch


class Arrangement(NamedTuple):
    """Panels in columns.  ``shown`` is less than the number of panels if there is no room for all."""

    shown: int
    rows: int
    columns: int


class Mark(NamedTuple):
    """An event in a plot: the time in s, a text, and one of the colours."""

    time: float
    text: str
    colour: str = ORANGE


def arrange(count: int, height: float, least: float = 1.2) -> Arrangement:
    """The fewest columns in which ``count`` panels of ``height`` inches, or of at least ``least``, have room."""
    most = int(_HEIGHT / min(least, height))
    columns = min(_COLUMNS, -(-count // most))
    shown = min(count, most * columns)
    return Arrangement(shown, -(-shown // columns), columns)


def panels(
    arrangement: Arrangement, heights: Sequence[float], marks: Sequence[Mark], span: tuple[float, float]
) -> tuple[Figure, list[list[Axes]]]:
    """A figure, and for each place of the arrangement its panels, one for each of ``heights`` in inches.

    All panels show the times ``span``.  The ``marks`` are lines in all panels; their texts are above.
    """
    from matplotlib.figure import Figure as NewFigure  # not pyplot, which can use a window system and has global state

    rows, columns = arrangement.rows, arrangement.columns
    width = _WIDTH if columns == 1 else _COLUMN * columns
    lanes = _lanes(marks, span, width / columns - 1.0)
    top = 0.1 + 0.19 * (1 + max(lanes, default=0)) if marks else 0.0
    block = min(sum(heights), _HEIGHT / rows)
    ratios = [*([top] if marks else []), *(height * block / sum(heights) for _ in range(rows) for height in heights)]
    figure: Any = NewFigure(figsize=(width, sum(ratios) + 0.5), layout="constrained")
    figure.get_layout_engine().set(h_pad=0.02)
    grid: Any = figure.subplots(len(ratios), columns, squeeze=False, gridspec_kw={"height_ratios": ratios})
    places = _places(grid[1 if marks else 0 :], arrangement, len(heights))
    for panel in grid.flat:  # not shared by matplotlib, which takes a minute for 50 panels
        panel.set_xlim(*span)
        panel.tick_params(labelbottom=bool(panel.get_xlabel()))
    for panel in grid[0] if marks else ():
        _write_marks(panel, marks, lanes)
    for found in places:
        for panel in found:
            panel.grid(True, color=GREY, alpha=0.3, linewidth=0.6)
            for mark in marks:
                panel.axvline(mark.time, color=mark.colour, linewidth=1.0, linestyle=(0, (1, 1.5)), zorder=1.5)
    return figure, places


def _places(grid: Any, arrangement: Arrangement, size: int) -> list[list[Axes]]:
    """The panels of each place that is shown, ``size`` of them one below the other.  The others are hidden."""
    places = []
    for place in range(arrangement.rows * arrangement.columns):
        column, row = divmod(place, arrangement.rows)  # the second place is below the first
        found = [line[column] for line in grid[row * size : (row + 1) * size]]
        if place < arrangement.shown:
            places.append(found)
            if row == arrangement.rows - 1 or place == arrangement.shown - 1:
                found[-1].set_xlabel("time (s)")
        else:
            for panel in found:
                panel.axis("off")
    return places


def _lanes(marks: Sequence[Mark], span: tuple[float, float], width: float) -> list[int]:
    """For each mark the line of text above the plot, so that no two texts overlap.  ``width`` is in inches."""
    ends: list[float] = []
    lanes = []
    scale = width / ((span[1] - span[0]) or 1.0)
    for mark in marks:
        begin, length = (mark.time - span[0]) * scale, 0.085 * len(mark.text) + 0.12
        begin = min(begin, width - length)
        lane = next((lane for lane, end in enumerate(ends) if end <= begin), len(ends))
        ends[lane : lane + 1] = [begin + length]
        lanes.append(lane)
    return lanes


def _write_marks(panel: Axes, marks: Sequence[Mark], lanes: Sequence[int]) -> None:
    """The texts of the marks, from top to bottom in their lanes, in a panel without a frame."""
    count = 1 + max(lanes)
    panel.set_ylim(-count, 0.0)
    panel.axis("off")
    for mark, lane in zip(marks, lanes):
        low, high = panel.get_xlim()
        right = (mark.time - low) > 0.5 * (high - low) and (high - mark.time) / (high - low) < 0.02 * len(mark.text)
        panel.plot([mark.time, mark.time], [-count, -lane - 0.5], color=mark.colour, linewidth=1.0, clip_on=False)
        panel.annotate(
            mark.text,
            (mark.time, -lane - 0.5),
            xytext=(-3 if right else 3, 0),
            textcoords="offset points",
            fontsize=SMALL,
            color=mark.colour,
            ha="right" if right else "left",
            va="center",
            annotation_clip=False,
        )


def legend(panel: Axes, columns: int = 4) -> None:
    """The legend at the top of the panel, above the curves."""
    handles, labels = panel.get_legend_handles_labels()
    if not labels:
        return
    low, high = panel.get_ylim()
    height = panel.get_position().height * panel.get_figure().get_size_inches()[1]
    lines = -(-len(labels) // columns)
    share = min(0.5, 0.21 * lines / max(height, 0.3) + 0.05)
    panel.set_ylim(low, high + (high - low) * share / (1.0 - share))
    panel.legend(
        handles,
        labels,
        loc="upper right",
        fontsize=SMALL,
        ncol=columns,
        framealpha=0.85,
        borderpad=0.25,
        handlelength=1.8,
        columnspacing=1.2,
    )


def with_unit(name: str, unit: str) -> str:
    """The label of an axis.

    >>> with_unit("pan", "rad"), with_unit("duty", "")
    ('pan (rad)', 'duty')
    """
    return f"{name} ({unit})" if unit else name


def save(figure: Figure, path: Path) -> None:
    """Writes a picture of the kind that the ending of ``path`` names: PNG, or SVG that is the same in each run."""
    import matplotlib

    svg = path.suffix == ".svg"
    with matplotlib.rc_context({"svg.hashsalt": "epg"}):
        metadata = {"Date": None, "Creator": None} if svg else {"Software": None}
        figure.savefig(path, dpi=_DOTS, metadata=metadata)
