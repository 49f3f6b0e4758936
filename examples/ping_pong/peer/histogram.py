# SPDX-License-Identifier: Apache-2.0
"""Histograms of round-trip times, as text and as a picture.  Bars are logarithmic, to show the few late ones."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path

BAR = "█"
WIDTH = 50


def bins(times: Sequence[float], most: int = 40) -> tuple[float, list[int]]:
    """Width of a bin (s; 1, 2 or 5 times a power of ten) and the counts of all bins from 0 s on."""
    largest = max(times)
    width = _round_up(largest / most)
    counts = [0] * (math.floor(largest / width) + 1)
    for time in times:
        counts[math.floor(time / width)] += 1
    return width, counts


def _round_up(value: float) -> float:
    power = 10.0 ** math.floor(math.log10(value))
    return next(step * power for step in (1.0, 2.0, 5.0, 10.0) if step * power >= value * (1.0 - 1e-12))


def text(times: Sequence[float]) -> str:
    """A line for each bin that is not empty: begin in ms, count, bar; "..." where bins are left out."""
    if not times:
        return "no round trip"
    width, counts = bins(times)
    scale = WIDTH / math.log10(1.0 + max(counts))
    lines = [f"{'ms':>8}  {'count':>7}"]
    for i, count in enumerate(counts):
        if count:
            bar = BAR * round(scale * math.log10(1.0 + count))
            lines.append(f"{1e3 * i * width:8.3f}  {count:7d}  {bar}")
        elif i > 0 and counts[i - 1]:
            lines.append(f"{'...':>8}")
    return "\n".join(lines)


def draw(runs: Sequence[tuple[str, Sequence[float]]], path: Path) -> None:
    """A panel for each (label, times) on one axis of time; needs matplotlib."""
    from matplotlib.figure import Figure

    runs = [(label, times) for label, times in runs if times]
    figure = Figure(figsize=(8.0, 0.8 + 1.9 * len(runs)), layout="constrained")
    panels = figure.subplots(len(runs), 1, sharex=True, squeeze=False)[:, 0]
    width, _ = bins([time for _, times in runs for time in times], most=120)
    for panel, (label, times) in zip(panels, runs):
        edges = [1e3 * width * i for i in range(math.floor(max(times) / width) + 2)]
        panel.hist([1e3 * time for time in times], bins=edges, color="#0072B2", log=True)
        ordered = sorted(times)
        panel.axvline(1e3 * ordered[len(ordered) // 2], color="#D55E00", linewidth=1.2)
        panel.set_title(f"{label}: median {1e3 * ordered[len(ordered) // 2]:.3f} ms", fontsize="small", loc="left")
        panel.set_ylabel("count")
        panel.grid(True, color="#999999", alpha=0.3, linewidth=0.6)
    panels[-1].set_xlabel("round trip (ms)")
    panels[-1].set_xlim(left=0.0)
    figure.savefig(path, dpi=150, metadata={"Software": None})
