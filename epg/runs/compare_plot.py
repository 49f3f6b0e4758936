# SPDX-License-Identifier: Apache-2.0
"""Plots recordings: one alone, or a comparison, with the difference of each signal below."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from pathlib import Path

from epg.runs.compare import Comparison, Pair
from epg.runs.panels import Panel
from epg.runs.plot_style import (
    BLACK,
    BLUE,
    GREEN,
    ORANGE,
    PURPLE,
    SKY,
    SMALL,
    Axes,
    Mark,
    arrange,
    legend,
    panels,
    save,
    with_unit,
)
from epg.runs.recording import Recording

_DASHES = (0, (4, 4))


def plot_comparison(
    comparison: Comparison, units: Mapping[str, str], names: tuple[str, str], path: Path, marks: Sequence[Mark] = ()
) -> int:
    """Writes the plot into ``path``.  Returns the number of signals that it shows.

    ``names`` are the names of the run and of the other run in the legend.  ``marks`` are events in the other run.
    """
    pairs = [pair for pair in comparison.pairs if not math.isnan(pair.rms)]
    heights = (2.6, 1.0)
    arrangement = arrange(len(pairs), sum(heights), 2.2)
    times = [time for pair in pairs for time in (pair.time[0], pair.time[-1])]
    span = (min(times), max(times))
    inside = [mark for mark in marks if span[0] <= mark.time <= span[1]]
    figure, places = panels(arrangement, heights, inside, span)
    for pair, (upper, lower) in zip(pairs, places):
        _draw_pair(pair, units.get(pair.name) or units.get(pair.against, ""), names, upper, lower)
    for _, lower in places:
        if lower.get_xlabel():
            lower.set_xlabel(f"time of {names[1]} (s)")
    figure.align_ylabels()
    save(figure, path)
    return arrangement.shown


def _draw_pair(pair: Pair, unit: str, names: tuple[str, str], upper: Axes, lower: Axes) -> None:
    upper.plot(pair.time, pair.reference, color=ORANGE, linewidth=2.4, label=names[1])
    upper.plot(pair.time, pair.run, color=BLUE, linewidth=1.4, label=names[0])
    upper.set_ylabel(_label(pair.name, unit))
    title = "" if pair.name == pair.against else f"{pair.name} against {pair.against}: "
    lag = f"{round(1000.0 * pair.lag, 1) + 0.0:+.1f} ms"
    numbers = f"RMS {pair.rms:.3g}, largest {pair.largest:.3g}{f' {unit}' if unit else ''}, lag {lag}"
    upper.set_title(f"{title}{numbers}", fontsize=SMALL, loc="left", pad=3.0)
    lower.plot(pair.time, [a - b for a, b in zip(pair.run, pair.reference)], color=BLUE, linewidth=0.9)
    lower.set_ylabel(with_unit("difference", unit).replace(" (", "\n("))
    legend(upper, 2)


def plot_recording(
    recording: Recording, found: Sequence[Panel], path: Path, title: str, marks: Sequence[Mark] = ()
) -> int:
    """Writes a plot of the panels ``found`` of one recording into ``path``.  Returns the number of panels in it."""
    arrangement = arrange(len(found), 2.4)
    shown = found[: arrangement.shown]
    times = [recording.signals[name].time for panel in shown for name in panel.names]
    span = (min(time[0] for time in times), max(time[-1] for time in times))
    figure, places = panels(arrangement, (2.4,), marks, span if span[0] < span[1] else (span[0], span[0] + 1.0))
    for one, (panel,) in zip(shown, places):
        _draw_signals(recording, one, panel, arrangement.columns)
    places[0][0].set_title(title, fontsize=SMALL, loc="left", pad=3.0)
    figure.align_ylabels()
    save(figure, path)
    return arrangement.shown


def _draw_signals(recording: Recording, one: Panel, panel: Axes, columns: int) -> None:
    for name, colour in zip(one.values, (BLUE, SKY, GREEN, PURPLE) * len(one.values)):
        signal = recording.signals[name]
        panel.plot(signal.time, signal.value, color=colour, linewidth=1.4, label=name)
    for name, colour in zip(one.setpoints, (BLACK, ORANGE) * len(one.setpoints)):
        signal = recording.signals[name]
        panel.plot(signal.time, signal.value, color=colour, linestyle=_DASHES, linewidth=1.1, label=name)
    if len(one.names) == 1:
        panel.set_ylabel(_label(one.names[0], one.unit), fontsize=SMALL if columns > 1 else None)
    else:
        panel.set_ylabel(with_unit(one.title, one.unit))
        legend(panel, min(len(one.names), 2 if columns > 1 else 3))


def _label(name: str, unit: str) -> str:
    """The label of a signal: a long name and its unit have a line each.

    >>> _label("pan", "rad"), _label("plant.outputs.angle_pan", "rad")
    ('pan (rad)', 'plant.outputs.\\nangle_pan (rad)')
    """
    if len(name) > 16 and "." in name:
        head, _, tail = name.rpartition(".")
        return f"{head}.\n{with_unit(tail, unit)}"
    return with_unit(name, unit)
