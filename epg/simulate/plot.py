# SPDX-License-Identifier: Apache-2.0
"""Plots a run: setpoint, reference and position of each axis over time, with the error below."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from pathlib import Path

from epg.diagnostics import Diagnostics
from epg.simulate.tracking import Tracking
from epg.source import Span

# M. Okabe, K. Ito, "Color Universal Design", 2008: users with any common colour vision can distinguish these colours
BLACK, BLUE, ORANGE, GREY = "#000000", "#0072B2", "#D55E00", "#999999"


GAP = 10.0
"""The number of control periods without a cycle from which on a line is broken: the target did not run."""


def plot(
    trackings: Sequence[Tracking], path: Path, diagnostics: Diagnostics, marks: Sequence[tuple[float, str]] = ()
) -> bool:
    """Writes the plot into ``path``.  Returns False, after a warning with a remedy, if matplotlib is not installed.

    ``marks`` are times in s with a text, such as failures of targets.
    """
    try:
        from matplotlib.figure import Figure  # not pyplot, which can use a window system and has global state
    except ImportError as error:
        diagnostics.warning(
            "matplotlib-missing",
            Span(path.name),
            f"not drawn: {error}",
            hint="python3 -m pip install matplotlib, or on Debian and Ubuntu: apt install python3-matplotlib",
        )
        return False
    count = len(trackings)
    figure = Figure(figsize=(8.0, 3.7 * count), layout="constrained")
    panels = figure.subplots(2 * count, 1, sharex=True, squeeze=False, gridspec_kw={"height_ratios": [3, 1] * count})
    for number, tracking in enumerate(trackings):
        _draw(tracking, panels[2 * number][0], panels[2 * number + 1][0])
    for time, text in marks:
        for panel in panels[:, 0]:
            panel.axvline(time, color=ORANGE, linewidth=0.9, linestyle=":")
        style = {"fontsize": "x-small", "rotation": 20.0, "color": ORANGE}
        panels[0][0].annotate(text, (time, 1.02), xycoords=("data", "axes fraction"), **style)
    panels[-1][0].set_xlabel("time (s)")
    panels[-1][0].set_xlim(0.0, max((tracking.time[-1] for tracking in trackings if tracking.time), default=1.0))
    figure.savefig(path, dpi=150, metadata={"Software": None})
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


def _draw(tracking: Tracking, upper, lower) -> None:  # type: ignore[no-untyped-def]  # matplotlib brings no types
    axis, tracking = tracking.axis, _broken(tracking)
    begin = axis.homing.until if axis.homing else 0.0
    shown = [i for i, time in enumerate(tracking.time) if time >= begin]
    if tracking.reference is not None:
        upper.plot(tracking.time, tracking.reference, color=ORANGE, linewidth=2.4, label="reference (ideal loop)")
    upper.plot(tracking.time, tracking.position, color=BLUE, linewidth=1.4, label="position")
    upper.plot(tracking.time, tracking.setpoint, color=BLACK, linestyle=(0, (4, 4)), linewidth=0.9, label="setpoint")
    upper.set_ylabel(f"{axis.name} ({axis.unit})" if axis.unit else axis.name)
    times = [tracking.time[i] for i in shown]
    milli = 1000.0 if axis.unit in ("rad", "m") else 1.0
    if tracking.reference is not None:
        ideal = [milli * (tracking.reference[i] - tracking.setpoint[i]) for i in shown]
        lower.plot(times, ideal, color=ORANGE, linewidth=1.8)
    errors = [milli * (tracking.position[i] - tracking.setpoint[i]) for i in shown]
    lower.plot(times, errors, color=BLUE, linewidth=0.9)
    lower.set_ylabel(f"error ({'m' if milli > 1 else ''}{axis.unit})" if axis.unit else "error")
    for panel in (upper, lower):
        panel.grid(True, color=GREY, alpha=0.3, linewidth=0.6)
        if begin > 0.0:
            label = "homing" if panel is upper else None
            panel.axvspan(0.0, begin, color=GREY, alpha=0.15, linewidth=0.0, label=label)
    upper.legend(loc="upper right", fontsize="small", ncol=4)
    low, high = upper.get_ylim()
    upper.set_ylim(low, high + 0.22 * (high - low))  # room for the legend
