# SPDX-License-Identifier: Apache-2.0
"""Plots a run.  For each axis: setpoint, reference and position over time, below them the error and the duty."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from pathlib import Path

from epg.diagnostics import Diagnostics
from epg.simulate.picture import (
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
from epg.simulate.tracking import Tracking, WindowResult
from epg.source import Span

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
            hint="python3 -m pip install matplotlib, or on Debian and Ubuntu: apt install python3-matplotlib",
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


def _draw(tracking: Tracking, windows: Sequence[WindowResult], end: float, found: Sequence[Axes]) -> None:
    axis, tracking = tracking.axis, _broken(tracking)
    upper, lower = found[:2]
    begin = axis.homing.until if axis.homing else 0.0
    if tracking.reference is not None:
        upper.plot(tracking.time, tracking.reference, color=ORANGE, linewidth=2.4, label="reference (ideal loop)")
    upper.plot(tracking.time, tracking.position, color=BLUE, linewidth=1.4, label="position")
    upper.plot(tracking.time, tracking.setpoint, color=BLACK, linestyle=(0, (4, 4)), linewidth=0.9, label="setpoint")
    upper.set_ylabel(with_unit(axis.name, axis.unit))
    if begin > 0.0:
        for panel in found:
            label = "homing" if panel is upper else None
            panel.axvspan(0.0, begin, color=GREY, alpha=0.15, linewidth=0.0, label=label)
    milli = 1000.0 if axis.unit in ("rad", "m") else 1.0
    shown = [i for i, time in enumerate(tracking.time) if time >= begin]
    times = [tracking.time[i] for i in shown]
    if tracking.reference is not None:
        ideal = [milli * (tracking.setpoint[i] - tracking.reference[i]) for i in shown]
        lower.plot(times, ideal, color=ORANGE, linewidth=1.8)
    errors = [milli * (tracking.setpoint[i] - tracking.position[i]) for i in shown]
    lower.plot(times, errors, color=BLUE, linewidth=0.9)
    unit = f"{'m' if milli > 1 else ''}{axis.unit}" if axis.unit else ""
    lower.set_ylabel(with_unit("error", unit))
    _draw_windows(windows, milli, end, lower)
    lower.set_title("error: setpoint - position", fontsize=SMALL, loc="left", pad=3.0)
    if len(found) > 2:
        duty = found[2]
        if tracking.duty is None:
            duty.set_yticks([])
            duty.annotate(
                "the scenario names no duty of this axis",
                (0.01, 0.5),
                xycoords="axes fraction",
                va="center",
                fontsize=SMALL,
            )
        else:
            duty.plot(tracking.time, tracking.duty, color=BLUE, linewidth=0.9)
            duty.set_ylabel("duty (1)")
    legend(upper)


def _draw_windows(windows: Sequence[WindowResult], milli: float, end: float, panel: Axes) -> None:
    """The windows in which the error is evaluated: the limits, and the numbers if there is room for them."""
    limits = [limit for one in windows for limit in (one.window.rms, one.window.largest) if limit is not None]
    if not limits:
        return
    low, high = panel.get_ylim()
    reach = 1.1 * max(-low, high, milli * max(limits))
    panel.set_ylim(-reach, 2.1 * reach)  # room for the numbers
    drawn: set[str] = set()
    for one in windows:
        window = one.window
        held = all(
            limit is None or value <= limit for value, limit in ((one.rms, window.rms), (one.largest, window.largest))
        )
        colour = GREEN if held else ORANGE
        panel.axvspan(window.start, window.end, color=colour, alpha=0.1, linewidth=0.0)
        for limit, name, style in (
            (window.largest, "limit of the largest error", "-"),
            (window.rms, "limit of the RMS", "--"),
        ):
            if limit is not None:
                for sign in (1.0, -1.0):
                    label = None if name in drawn else name
                    drawn.add(name)
                    ends = [window.start, window.end]
                    panel.plot(
                        ends, [sign * milli * limit] * 2, color=PURPLE, linestyle=style, linewidth=1.1, label=label
                    )
        if (window.end - window.start) / end > _NARROW:
            wide = (window.end - window.start) / end > 2.0 * _NARROW
            rms = ("" if held else "not held: ") + f"RMS {milli * one.rms:.3g}"
            text = f"{rms},{' ' if wide else chr(10)}largest {milli * one.largest:.3g}"
            at = (0.5 * (window.start + window.end), 1.05 * reach)
            panel.annotate(text, at, ha="center", va="bottom", fontsize=SMALL, color=BLACK if held else ORANGE)
    handles, labels = panel.get_legend_handles_labels()
    panel.legend(handles, labels, loc="lower right", bbox_to_anchor=(1.0, 0.98), fontsize=SMALL, ncol=2, frameon=False)
