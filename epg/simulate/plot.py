# SPDX-License-Identifier: Apache-2.0
"""Plots a run.  For each axis: setpoint, reference and position over time, below them the error and the duty."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from pathlib import Path

from epg.generator.diagnostics import Diagnostics
from epg.generator.install import package_commands
from epg.generator.source import Span
from epg.runs.plot_style import (
    BLACK,
    BLUE,
    GREEN,
    GREY,
    ORANGE,
    PURPLE,
    SMALL,
    Axes,
    Mark,
    arrange,
    legend,
    panels,
    save,
    with_unit,
)
from epg.runs.scenario import Window
from epg.runs.tracking import Tracking, WindowResult

GAP = 10.0
"""The number of control periods without a cycle from which on a line is broken: the target did not run."""

_HEIGHTS = (2.6, 1.35)
"""Inches: the panel with the position, the panel with the error."""
_DUTY_HEIGHT = 0.85

_NARROW = 0.11
"""The part of the shown time from which on a window has room for its numbers."""


def plot(
    trackings: Sequence[Tracking],
    windows: Sequence[WindowResult],
    path: Path,
    diagnostics: Diagnostics,
    marks: Sequence[Mark] = (),
) -> bool:
    """Writes the plot into ``path``.  Returns False, after a warning with a remedy, if matplotlib is not installed.

    ``windows`` are the results of the windows of all axes.  ``marks`` are events such as failures of targets.
    """
    try:
        import matplotlib.figure  # noqa: F401  # a test that it is there
    except ImportError as error:
        diagnostics.warning(
            "matplotlib-missing",
            Span(path.name),
            f"not drawn: {error}",
            hint=", or: ".join(package_commands(["matplotlib"])),
        )
        return False
    heights = [*_HEIGHTS, *([_DUTY_HEIGHT] if any(tracking.duty is not None for tracking in trackings) else [])]
    end = max((tracking.time[-1] for tracking in trackings if tracking.time), default=1.0) or 1.0
    arrangement = arrange(len(trackings), sum(heights), 0.6 * sum(heights))
    if arrangement.shown < len(trackings):
        message = f"the plot shows the first {arrangement.shown} of {len(trackings)} axes"
        diagnostics.warning("too-much-to-plot", Span(path.name), message, hint="'tracking.csv' has all of them")
    figure, places = panels(arrangement, heights, sorted(marks), (0.0, end))
    for tracking, found in zip(trackings, places):
        own = [result for result in windows if result.axis == tracking.axis.name]
        _draw(tracking, own, end, found)
    figure.align_ylabels()
    save(figure, path)
    return True


def _broken(tracking: Tracking) -> Tracking:
    """The same with a value that is not a number in each gap, at which matplotlib breaks a line."""
    time = tracking.time
    largest = GAP * (time[1] - time[0]) if len(time) > 1 else 0.0
    gaps = [at for at in range(1, len(time)) if time[at] - time[at - 1] > largest]
    if not gaps:
        return tracking

    def filled(values: Sequence[float], gap: Callable[[int], float]) -> list[float]:
        parts = [[gap(at), *values[at:end]] for at, end in zip(gaps, [*gaps[1:], len(values)])]
        return [*values[: gaps[0]], *(value for part in parts for value in part)]

    def column(values: Sequence[float] | None) -> list[float] | None:
        return None if values is None else filled(values, lambda at: math.nan)

    return Tracking(
        tracking.axis,
        filled(time, lambda at: time[at - 1] + largest / GAP),
        filled(tracking.setpoint, lambda at: math.nan),
        filled(tracking.position, lambda at: math.nan),
        column(tracking.reference),
        column(tracking.duty),
    )


def _draw(tracking: Tracking, windows: Sequence[WindowResult], end: float, axes: Sequence[Axes]) -> None:
    """Draws an axis into its panels: position, error, and duty if one of the axes has it."""
    tracking = _broken(tracking)
    homed = tracking.axis.homing.until if tracking.axis.homing else 0.0
    _draw_position(tracking, axes[0])
    if homed > 0.0:
        for panel in axes:
            label = "homing" if panel is axes[0] else None
            panel.axvspan(0.0, homed, color=GREY, alpha=0.15, linewidth=0.0, label=label)
    _draw_error(tracking, homed, windows, end, axes[1])
    for panel in axes[2:]:
        _draw_duty(tracking, panel)
    legend(axes[0])


def _draw_position(tracking: Tracking, panel: Axes) -> None:
    if tracking.reference is not None:
        panel.plot(tracking.time, tracking.reference, color=ORANGE, linewidth=2.4, label="reference (ideal loop)")
    panel.plot(tracking.time, tracking.position, color=BLUE, linewidth=1.4, label="position")
    panel.plot(tracking.time, tracking.setpoint, color=BLACK, linestyle=(0, (4, 4)), linewidth=0.9, label="setpoint")
    panel.set_ylabel(with_unit(tracking.axis.name, tracking.axis.unit))


def _draw_error(tracking: Tracking, begin: float, windows: Sequence[WindowResult], end: float, panel: Axes) -> None:
    """Draws the error from ``begin`` on, and the windows in which it is evaluated."""
    unit = tracking.axis.unit
    milli = 1000.0 if unit in ("rad", "m") else 1.0
    shown = [i for i, time in enumerate(tracking.time) if time >= begin]
    times = [tracking.time[i] for i in shown]
    if tracking.reference is not None:
        ideal = [milli * (tracking.setpoint[i] - tracking.reference[i]) for i in shown]
        panel.plot(times, ideal, color=ORANGE, linewidth=1.8)
    errors = [milli * (tracking.setpoint[i] - tracking.position[i]) for i in shown]
    panel.plot(times, errors, color=BLUE, linewidth=0.9)
    panel.set_ylabel(with_unit("error", f"m{unit}" if milli > 1 else unit))
    _draw_windows(windows, milli, end, panel)
    panel.set_title("error: setpoint - position", fontsize=SMALL, loc="left", pad=3.0)


def _draw_duty(tracking: Tracking, panel: Axes) -> None:
    if tracking.duty is None:
        text = "the scenario names no duty of this axis"
        panel.set_yticks([])
        panel.annotate(text, (0.01, 0.5), xycoords="axes fraction", va="center", fontsize=SMALL)
    else:
        panel.plot(tracking.time, tracking.duty, color=BLUE, linewidth=0.9)
        panel.set_ylabel("duty (1)")


def _draw_windows(windows: Sequence[WindowResult], milli: float, end: float, panel: Axes) -> None:
    """The windows in which the error is evaluated: the limits, and the numbers if there is room for them."""
    limits = [limit for one in windows for limit in (one.window.rms, one.window.largest) if limit is not None]
    if not limits:
        return
    low, high = panel.get_ylim()
    reach = 1.1 * max(-low, high, milli * max(limits))
    panel.set_ylim(-reach, 2.1 * reach)  # room for the numbers
    for one in windows:
        window = one.window
        panel.axvspan(window.start, window.end, color=GREEN if one.held else ORANGE, alpha=0.1, linewidth=0.0)
        _draw_limit(window, window.largest, milli, panel, "limit of the largest error", "-")
        _draw_limit(window, window.rms, milli, panel, "limit of the RMS", "--")
        part = (window.end - window.start) / end
        if part > _NARROW:
            rms = ("" if one.held else "not held: ") + f"RMS {milli * one.rms:.3g}"
            text = f"{rms},{' ' if part > 2.0 * _NARROW else chr(10)}largest {milli * one.largest:.3g}"
            at = (0.5 * (window.start + window.end), 1.05 * reach)
            panel.annotate(text, at, ha="center", va="bottom", fontsize=SMALL, color=BLACK if one.held else ORANGE)
    handles, labels = panel.get_legend_handles_labels()
    panel.legend(handles, labels, loc="lower right", bbox_to_anchor=(1.0, 0.98), fontsize=SMALL, ncol=2, frameon=False)


def _draw_limit(window: Window, limit: float | None, milli: float, panel: Axes, name: str, style: str) -> None:
    """Draws a limit above and below zero.  Its name is in the legend once."""
    for value in (limit, -limit) if limit is not None else ():
        label = None if name in panel.get_legend_handles_labels()[1] else name
        ends = [window.start, window.end]
        panel.plot(ends, [milli * value] * 2, color=PURPLE, linestyle=style, linewidth=1.1, label=label)
