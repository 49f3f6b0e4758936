# SPDX-License-Identifier: Apache-2.0
"""Draws a finished simulation: setpoint, reference and position of each axis over time, with the error below.

>>> # svg = draw_tracking(Path("build/tracking.csv"), scenario)
"""

from __future__ import annotations

import math
from array import array
from collections.abc import Mapping, Sequence
from pathlib import Path

from epg.graph.svg import Picture, width
from epg.runs.recording import Signal, read_table
from epg.runs.scenario import Axis, Scenario

WIDE, HIGH, LOW = 720.0, 190.0, 70.0
"""The width of all panels, and the heights of the upper and the lower panel of an axis, in pixels."""
_LEFT = 84.0
_SMALL = 11.0
_POSITION, _REFERENCE, _SETPOINT = "w0", "w1", "earth"
Points = list[tuple[float, float]]


def draw_tracking(file: Path, scenario: Scenario | None) -> str:
    """The picture of ``tracking.csv`` as ``epg simulate`` writes it.  Raises OSError; ``scenario`` has no mistakes."""
    assert scenario is not None, "the simulation has read it"
    signals = read_table(file).signals
    end = float(scenario.duration)
    names = ", ".join(axis.name for axis in scenario.axes)
    picture = Picture("Simulation", f"Setpoint and position of {names} over {end:g} s, and the error below each.")
    top = 0.0
    for axis in scenario.axes:
        top = _draw_axis(picture, axis, signals, end, top)
    picture.text(_LEFT + WIDE / 2, top, "time in s", "middle")
    return picture.render()


def _draw_axis(picture: Picture, axis: Axis, signals: Mapping[str, Signal], end: float, top: float) -> float:
    """Draws the two panels of an axis from ``top`` on.  Returns the top of what follows."""
    time = signals[f"{axis.name}_position"].time
    setpoint, position = signals[f"{axis.name}_setpoint"].value, signals[f"{axis.name}_position"].value
    ideal = signals.get(f"{axis.name}_reference")
    reference = ideal.value if ideal else ()
    unit = f" in {axis.unit}" if axis.unit else ""
    picture.text(_LEFT, top + 12, f"{axis.name}{unit}", style="bold")
    legend = _LEFT + width(f"{axis.name}{unit}") + 24
    shown = [("position", _POSITION), ("setpoint", _SETPOINT)] + ([("reference", _REFERENCE)] if reference else [])
    for title, style in shown:
        picture.line([(legend, top + 8), (legend + 24, top + 8)], style)
        picture.text(legend + 30, top + 12, title)
        legend += 54 + width(title)
    top += 20
    lines = [(setpoint, _SETPOINT), (position, _POSITION)]
    lines = [*([(reference, _REFERENCE)] if reference else []), *reversed(lines)]
    begin = axis.homing.until if axis.homing is not None else 0.0
    _panel(picture, top, HIGH, time, lines, end, begin)
    top += HIGH + 18
    errors = array("d", (p - s if t >= begin else math.nan for t, p, s in zip(time, position, setpoint)))
    picture.text(_LEFT, top + 8, f"error{unit}", size=_SMALL)
    top += 14
    _panel(picture, top, LOW, time, [(errors, _POSITION)], end, begin, seconds=True)
    return top + LOW + 34


def _panel(
    picture: Picture,
    top: float,
    high: float,
    time: Sequence[float],
    lines: Sequence[tuple[Sequence[float], str]],
    end: float,
    begin: float,
    *,
    seconds: bool = False,
) -> None:
    """One panel.  The time before ``begin`` is shaded; with ``seconds`` it has the numbers of the time axis."""
    values = [value for line, _ in lines for value in line if math.isfinite(value)]
    low, up = (min(values), max(values)) if values else (0.0, 1.0)
    margin = 0.06 * (up - low) or 0.5
    low, up = low - margin, up + margin

    def x(at: float) -> float:
        return _LEFT + WIDE * at / end

    def y(value: float) -> float:
        return top + high * (up - value) / (up - low)

    if begin > 0.0:
        picture.box(_LEFT, top, WIDE * min(begin / end, 1.0), high, "box", "homing", round=0)
        picture.text(_LEFT + 6, top + 14, "homing", size=_SMALL, style="faint")
    for value in ticks(low, up, 4 if high > LOW else 2):
        picture.line([(_LEFT, y(value)), (_LEFT + WIDE, y(value))], "grid")
        picture.text(_LEFT - 6, y(value) + 4, f"{value:g}", "end", _SMALL, "faint")
    if seconds:
        for at in ticks(0.0, end, 9):
            picture.text(x(at), top + high + 14, f"{at:g}", "middle", _SMALL, "faint")
    picture.line([(_LEFT, top), (_LEFT, top + high), (_LEFT + WIDE, top + high)], "line")
    for line, style in lines:
        for part in _thinned(time, line, end):
            picture.line([(x(at), y(value)) for at, value in part], style)


def ticks(low: float, high: float, most: int) -> list[float]:
    """Round numbers between ``low`` and ``high``, at most ``most`` + 1: multiples of 1, 2 or 5 times a power of ten.

    >>> ticks(-0.02, 0.31, 4)
    [0.0, 0.1, 0.2, 0.3]
    """
    power = 10.0 ** math.floor(math.log10((high - low) / most))
    step = next(factor * power for factor in (1, 2, 5, 10) if factor * power * most >= high - low)
    first, last = math.ceil(low / step - 1e-9), math.floor(high / step + 1e-9)
    return [round(number * step, 12) + 0.0 for number in range(first, last + 1)]


def _thinned(time: Sequence[float], values: Sequence[float], end: float) -> list[Points]:
    """The points of a line, at most the smallest and the largest for each pixel.  A value that is missing breaks it."""
    parts: list[Points] = []
    gap, pixel = True, -1
    inside: Points = []

    def flush() -> None:
        if inside:
            least, most = min(inside, key=lambda point: point[1]), max(inside, key=lambda point: point[1])
            parts[-1] += sorted({least, most, inside[-1]})
            inside.clear()

    for at, value in zip(time, values):
        if not math.isfinite(value):
            flush()
            gap = True
            continue
        if gap or int(WIDE * at / end) != pixel:
            flush()
            pixel = int(WIDE * at / end)
        if gap:
            parts.append([])
            gap = False
        inside.append((at, value))
    flush()
    return [part for part in parts if len(part) > 1]
