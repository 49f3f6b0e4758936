# SPDX-License-Identifier: Apache-2.0
"""Draws measured and simulated positions in one picture, with their difference and the duty below."""

from __future__ import annotations

from pathlib import Path

from epg.identify.fit import Fit
from epg.identify.samples import Samples
from epg.runs.plot_style import BLUE, ORANGE, SMALL, Arrangement, legend, panels, save, with_unit

_HEIGHTS = (3.0, 1.1, 1.1)


def plot_fit(samples: Samples, fit: Fit, names: tuple[str, str], unit: str, title: str, path: Path) -> None:
    """Writes the picture.  ``names`` are the signals of position and duty, ``unit`` is that of the position."""
    span = (float(samples.time[0]), float(samples.time[-1]))
    figure, ((curve, error, duty),) = panels(Arrangement(1, 1, 1), _HEIGHTS, (), span)
    curve.plot(samples.time, samples.position, color=ORANGE, linewidth=4.5, label="measured")
    curve.plot(samples.time, fit.simulated, color=BLUE, linewidth=1.3, label="simulated")
    curve.set_ylabel(with_unit(names[0], unit))
    curve.set_title(title, fontsize=SMALL, loc="left", pad=3.0)
    legend(curve)
    error.plot(samples.time, samples.position - fit.simulated, color=BLUE, linewidth=0.9)
    error.set_ylabel(with_unit("difference", unit).replace(" (", "\n("))
    duty.step(samples.time, samples.duty, where="post", color=BLUE, linewidth=1.2)
    duty.set_ylabel(names[1].replace(".", ".\n"))
    figure.align_ylabels()
    save(figure, path)
