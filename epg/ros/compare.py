# SPDX-License-Identifier: Apache-2.0
"""Two recordings of the same motion: how much later one is than the other, and how far apart they are after that.

One shift in time aligns all signals of the runs, because each run has one clock.  It is sought on a grid as the shift
with the least mean square difference, which is where the cross-correlation is largest, but does not favour shifts at
which the runs overlap long.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from epg.ros.recording import Recording, Signal

GRID = 20_000
"""Most points of a run that are compared: an hour at 5 Hz, 20 s at 1 kHz."""
LEAST_STEP = 0.001
LEAST_OVERLAP = 0.5
"""Of the shorter run."""
MOTION = 0.02
"""Of a signal's range: beyond this it has left where it began."""
_LAG_REACH = 1.0
"""Longest lag of one signal behind the others that is looked for, s."""


@dataclass(frozen=True)
class Pair:
    """One signal of both runs on a common grid, after the runs were aligned.  ``time`` is the reference's, s.

    ``lag`` is how much later the run's signal is than the reference's once the runs are aligned, s; ``rms`` and
    ``largest`` are of run - reference as they stand, ``rms_without_lag`` after shifting by ``lag`` too.
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
    """``shift`` was added to the times of the run, s."""

    shift: float
    pairs: tuple[Pair, ...]


def compare(
    run: Recording,
    reference: Recording,
    pairs: Mapping[str, str],
    align: str,
    by: Mapping[str, str],
    window: tuple[float, float] = (-math.inf, math.inf),
) -> Comparison:
    """``pairs``: signals of ``run`` and what they are called in ``reference``; ``by``: likewise, those that align the
    runs; ``align`` is "correlation", "motion" or "none".  ``window`` of the reference's time is compared; all that was
    recorded aligns the runs.  Needs numpy.
    """
    import numpy as np

    step = max(LEAST_STEP, max(_length(r) for r in (run, reference)) / GRID)
    both = {name: (run.signals[name], reference.signals[other]) for name, other in pairs.items()}
    chosen = [(run.signals[name], reference.signals[other]) for name, other in by.items()]
    shift = 0.0
    if align == "motion":
        shift = float(np.median([_motion(reference) - _motion(signal) for signal, reference in chosen]))
    elif align == "correlation":
        shift = _best_shift(chosen, step)
    return Comparison(
        shift,
        tuple(_pair(name, pairs[name], *signals, shift, step, window) for name, signals in both.items()),
    )


def _length(recording: Recording) -> float:
    return max(s.time[-1] for s in recording.signals.values()) - min(s.time[0] for s in recording.signals.values())


def _motion(signal: Signal) -> float:
    """When the signal first leaves the neighbourhood of its first value."""
    low, high = min(signal.value), max(signal.value)
    first, reach = signal.value[0], MOTION * (high - low)
    return next((t for t, v in zip(signal.time, signal.value) if abs(v - first) > reach), signal.time[0])


def _sampled(signal: Signal, times: Any) -> Any:
    """The signal at ``times``, straight between its points."""
    import numpy as np

    return np.interp(times, np.asarray(signal.time), np.asarray(signal.value))


def _best_shift(signals: Sequence[tuple[Signal, Signal]], step: float) -> float:
    """What to add to the run's time; all signals count the same, whatever their units and ranges."""
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
    """Mean of (a[i] - b[i + k])^2 over what overlaps, for k = 1 - len(a) ... len(b) - 1; infinite where that is short.

    The products are a cross-correlation (by FFT), the squares are sums of what lies under the overlap.
    """
    import numpy as np

    offset = float(np.mean(b))  # smaller numbers, smaller errors
    a, b = a - offset, b - offset
    size = len(a) + len(b) - 1
    spectrum = np.fft.rfft(b, size) * np.conj(np.fft.rfft(a, size))
    products = np.roll(np.fft.irfft(spectrum, size), len(a) - 1)
    k = np.arange(1 - len(a), len(b))
    first, last = np.maximum(0, -k), np.minimum(len(a), len(b) - k)  # of a
    squares_a, squares_b = (np.concatenate(([0.0], np.cumsum(x * x))) for x in (a, b))
    squares = squares_a[last] - squares_a[first] + squares_b[last + k] - squares_b[first + k]
    count = last - first
    with np.errstate(divide="ignore", invalid="ignore"):
        means = (squares - 2.0 * products) / count
    means[count < LEAST_OVERLAP * min(len(a), len(b))] = np.inf
    return means


def _between(values: Any, index: int) -> float:
    """Where between grid points the least value lies: the vertex of the parabola through three of them."""
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
    """Both signals where both were recorded; nothing but NaN if that is nowhere."""
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
    """How much later ``a`` is than ``b``, s; 0 where nothing moves."""
    import numpy as np

    if np.ptp(a) == 0.0 or np.ptp(b) == 0.0:
        return 0.0
    means = _mean_squares(a, b)
    zero = len(a) - 1
    reach = min(round(_LAG_REACH / step), zero)
    near = means[zero - reach : zero + reach + 1]
    index = int(np.argmin(near))
    return -step * (index - reach + _between(near, index))
