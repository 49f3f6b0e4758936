# SPDX-License-Identifier: Apache-2.0
"""Plots a comparison: for each signal, both runs in one panel and their difference below."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path

from epg.ros.compare import Comparison, Pair
from epg.ros.recording import Recording
from epg.simulate.plot import BLUE, GREY, ORANGE


def plot_comparison(comparison: Comparison, run: str, reference: str, path: Path) -> None:
    """Writes the plot into ``path``.  ``run`` and ``reference`` are the names of the runs in the legend."""
    from matplotlib.figure import Figure  # not pyplot, which can use a window system and has global state

    pairs = [pair for pair in comparison.pairs if not math.isnan(pair.rms)]
    figure = Figure(figsize=(8.0, 3.7 * len(pairs)), layout="constrained")
    panels = figure.subplots(
        2 * len(pairs), 1, sharex=True, squeeze=False, gridspec_kw={"height_ratios": [3, 1] * len(pairs)}
    )
    for number, pair in enumerate(pairs):
        _draw(pair, run, reference, panels[2 * number][0], panels[2 * number + 1][0])
    panels[-1][0].set_xlabel(f"time of {reference} (s)")
    figure.align_ylabels()
    figure.savefig(path, dpi=150, metadata={"Software": None})


def _draw(pair: Pair, run: str, reference: str, upper, lower) -> None:  # type: ignore[no-untyped-def]
    upper.plot(pair.time, pair.reference, color=ORANGE, linewidth=2.4, label=reference)
    upper.plot(pair.time, pair.run, color=BLUE, linewidth=1.4, label=run)
    names = pair.name if pair.name == pair.against else f"{pair.name}\nagainst {pair.against}"
    upper.set_ylabel(names)
    upper.set_title(
        f"RMS {pair.rms:.3g}, largest {pair.largest:.3g}, lag {round(1000.0 * pair.lag, 1) + 0.0:+.1f} ms",
        fontsize="small",
        loc="left",
    )
    lower.plot(pair.time, [a - b for a, b in zip(pair.run, pair.reference)], color=BLUE, linewidth=0.9)
    lower.set_ylabel("difference")
    _finish(upper, lower)


def plot_recording(recording: Recording, names: Sequence[str], path: Path) -> None:
    """Writes a plot of the signals ``names`` of one recording into ``path``, one below the other."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(8.0, 2.6 * len(names)), layout="constrained")
    panels = figure.subplots(len(names), 1, sharex=True, squeeze=False)
    for panel, name in zip(panels[:, 0], names):
        signal = recording.signals[name]
        panel.plot(signal.time, signal.value, color=BLUE, linewidth=1.2)
        panel.set_ylabel(name)
        panel.grid(True, color=GREY, alpha=0.3, linewidth=0.6)
    panels[-1][0].set_xlabel("time (s)")
    figure.savefig(path, dpi=150, metadata={"Software": None})


def _finish(upper, lower) -> None:  # type: ignore[no-untyped-def]
    for panel in (upper, lower):
        panel.grid(True, color=GREY, alpha=0.3, linewidth=0.6)
    upper.legend(loc="upper right", fontsize="small", ncol=2)
    low, high = upper.get_ylim()
    upper.set_ylim(low, high + 0.22 * (high - low))  # room for the legend
