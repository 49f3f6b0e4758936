# SPDX-License-Identifier: Apache-2.0
"""Compares two recordings of the same motion: the time by which one is later, and the remaining differences.

All signals of a run are shifted by the same time, because each run has one clock.  The best shift is the one with the
least mean square difference, searched on a grid.  The maximum of the cross-correlation is similar, but it prefers
shifts at which the runs overlap for a long time.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

from epg.generator.dataclass import dataclass
from epg.runs.recording import Signal

GRID = 20_000
"""The largest number of points of the grid: an hour at 5 Hz, 20 s at 1 kHz."""
LEAST_STEP = 0.001
"""The smallest step of the grid, in seconds."""
LEAST_OVERLAP = 0.5
"""The smallest overlap of the runs, as a part of the shorter run."""
MOTION = 0.02
"""A signal has moved if it differs from its first value by more than this part of its range."""
_LAG_REACH = 1.0
"""The longest lag of one signal behind the others, in seconds."""


@dataclass(frozen=True)
class Pair:
    """One signal of both runs on a common grid, after the runs were aligned.

    ``name`` is its name in the run and ``against`` its name in the reference.  ``time`` is the time of the reference,
    in seconds.  ``lag`` is the time in seconds by which the run's signal is still later than the reference's.

    ``rms`` and ``largest`` are those of run - reference.  ``rms_without_lag`` is the RMS after the run's signal was
    also shifted by ``lag``.  ``range`` is the range of the reference's values.
    """

    name: str
    against: str
    time: Sequence[float]
    run: Sequence[float]
    reference: Sequence[float]
    rms: float
    largest: float
    lag: float
    rms_without_lag: float
    range: float


@dataclass(frozen=True)
class Comparison:
    """The result of a comparison.  ``shift``, in seconds, was added to the times of the run."""

    shift: float
    pairs: tuple[Pair, ...]


def compare(
    run: Mapping[str, Signal],
    reference: Mapping[str, Signal],
    pairs: Mapping[str, str],
    align: str,
    by: Mapping[str, str],
    window: tuple[float, float] = (-math.inf, math.inf),
) -> Comparison:
    """Aligns ``run`` with ``reference`` and compares their signals.  Needs numpy.

    ``pairs`` are the signals to compare, and ``by`` those that align the runs: the name in ``run``, and the name in
    ``reference``.  ``align`` is "correlation", "motion" or "none".  Only ``window``, in seconds of the reference's
    time, is compared, but the whole recordings are used to align the runs.
    """
    import numpy as np

    step = max(LEAST_STEP, max(_length(r) for r in (run, reference)) / GRID)
    both = {name: (run[name], reference[other]) for name, other in pairs.items()}
    chosen = [(run[name], reference[other]) for name, other in by.items()]
    shift = 0.0
    if align == "motion":
        shift = float(np.median([_motion(reference) - _motion(signal) for signal, reference in chosen]))
    elif align == "correlation":
        shift = _best_shift(chosen, step)
    return Comparison(
        shift,
        tuple(_pair(name, pairs[name], *signals, shift, step, window) for name, signals in both.items()),
    )


def _length(signals: Mapping[str, Signal]) -> float:
    return max(s.time[-1] for s in signals.values()) - min(s.time[0] for s in signals.values())


def _motion(signal: Signal) -> float:
    """The time in seconds at which the signal first differs from its first value by more than :data:`MOTION`."""
    low, high = min(signal.value), max(signal.value)
    first, reach = signal.value[0], MOTION * (high - low)
    return next((t for t, v in zip(signal.time, signal.value) if abs(v - first) > reach), signal.time[0])


def _sampled(signal: Signal, times: Any) -> Any:
    """The signal at ``times``, by linear interpolation."""
    import numpy as np

    return np.interp(times, np.asarray(signal.time), np.asarray(signal.value))


def _best_shift(signals: Sequence[tuple[Signal, Signal]], step: float) -> float:
    """The time in seconds to add to the run's times.  Signals are scaled, so that all have the same weight."""
    import numpy as np

    run_begin = min(run.time[0] for run, _ in signals)
    reference_begin = min(reference.time[0] for _, reference in signals)
    total: Any = 0.0
    for run, reference in signals:
        b = _sampled(reference, np.arange(reference_begin, max(r.time[-1] for _, r in signals), step))
        a = _sampled(run, np.arange(run_begin, max(r.time[-1] for r, _ in signals), step))
        scale = float(np.std(b)) or float(np.std(a)) or 1.0
        total = total + _mean_squares(a / scale, b / scale)
    lag = int(np.argmin(total))
    return reference_begin - run_begin + step * (lag + _between(total, lag) - (len(a) - 1))


def _mean_squares(a: Any, b: Any) -> Any:
    """The mean of (a[i] - b[i + k])^2 over the overlap, for k = 1 - len(a) ... len(b) - 1.

    Infinite if the overlap is shorter than :data:`LEAST_OVERLAP`.  The products are a cross-correlation, computed by
    FFT.  The sums of squares over the overlap are differences of cumulative sums.
    """
    import numpy as np

    offset = float(np.mean(b))  # smaller numbers have smaller rounding errors
    a, b = a - offset, b - offset
    size = len(a) + len(b) - 1
    spectrum = np.fft.rfft(b, size) * np.conj(np.fft.rfft(a, size))
    products = np.roll(np.fft.irfft(spectrum, size), len(a) - 1)
    k = np.arange(1 - len(a), len(b))
    first, last = np.maximum(0, -k), np.minimum(len(a), len(b) - k)  # the overlap, as indices of a
    squares_a, squares_b = (np.concatenate(([0.0], np.cumsum(x * x))) for x in (a, b))
    squares = squares_a[last] - squares_a[first] + squares_b[last + k] - squares_b[first + k]
    count = last - first
    with np.errstate(divide="ignore", invalid="ignore"):
        means = (squares - 2.0 * products) / count
    means[count < LEAST_OVERLAP * min(len(a), len(b))] = np.inf
    return means


def _between(values: Any, index: int) -> float:
    """The position of the minimum relative to ``index``: the vertex of the parabola through three points there."""
    if not 0 < index < len(values) - 1:
        return 0.0
    before, here, after = (float(v) for v in values[index - 1 : index + 2])
    curvature = before - 2.0 * here + after
    return 0.5 * (before - after) / curvature if 0.0 < curvature < float("inf") else 0.0


def _pair(
    name: str,
    against: str,
    run: Signal,
    reference: Signal,
    shift: float,
    step: float,
    window: tuple[float, float],
) -> Pair:
    """Compares two signals over the time in which both were recorded.  All results are NaN if there is no such time."""
    import numpy as np

    begin = max(run.time[0] + shift, reference.time[0], window[0])
    end = min(run.time[-1] + shift, reference.time[-1], window[1])
    times: Any = np.arange(begin, end, step)
    a, b = _sampled(run, times - shift), _sampled(reference, times)
    if len(times) < 3:
        nan = float("nan")
        return Pair(name, against, times, a, b, nan, nan, nan, nan, nan)
    lag = _lag(a, b, step)
    late = _sampled(run, times - shift + lag)
    difference = a - b
    return Pair(
        name,
        against,
        times,
        a,
        b,
        rms=float(np.sqrt(np.mean(difference**2))),
        largest=float(np.max(np.abs(difference))),
        lag=lag,
        rms_without_lag=float(np.sqrt(np.mean((late - b) ** 2))),
        range=float(np.ptp(b)),
    )


def _lag(a: Any, b: Any, step: float) -> float:
    """The time in seconds by which ``a`` is later than ``b``; 0 if one of them is constant."""
    import numpy as np

    if np.ptp(a) == 0.0 or np.ptp(b) == 0.0:
        return 0.0
    means = _mean_squares(a, b)
    zero = len(a) - 1
    reach = min(round(_LAG_REACH / step), zero)
    near = means[zero - reach : zero + reach + 1]
    index = int(np.argmin(near))
    return -step * (index - reach + _between(near, index))
