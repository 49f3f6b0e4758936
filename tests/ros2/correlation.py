# SPDX-License-Identifier: Apache-2.0
"""The delay of one signal behind another, computed as in the thesis for its tables 5.5 and 5.6."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

Log = Sequence[tuple[float, float]]
"""Pairs of time in s and value, as a node logs them when they become available."""


def lag(reference: Log, target: Log) -> float:
    """The time in seconds by which ``target`` is behind ``reference``, in multiples of the reference's interval.

    The target is interpolated to the times of the reference, so that both have the same time scale.  The result is the
    shift with the largest cross-correlation.  The thesis does not define its treatment of means and ends.  Here it is
    the correlation coefficient of the overlapping parts.  (A sum of products would favour no shift, because a larger
    shift leaves fewer products.)

    >>> wave = [(0.033 * n, np.sin(0.05 * n)) for n in range(200)]
    >>> late = [(time + 0.066, value) for time, value in wave]
    >>> round(lag(wave, late), 3)
    0.066
    """
    times = np.array([time for time, _ in reference])
    values = np.array([value for _, value in reference])
    other = np.interp(times, [time for time, _ in target], [value for _, value in target])
    count = len(values)
    correlations = {
        shift: np.corrcoef(values[max(0, -shift) : count - max(0, shift)], other[max(0, shift) : count + min(0, shift)])
        for shift in range(-count // 4, count // 4 + 1)
    }
    shift = max(correlations, key=lambda shift: correlations[shift][0, 1])
    return shift * float(np.mean(np.diff(times)))


def fine_lag(reference: Log, target: Log, largest: float = 0.3, step: float = 0.001) -> float:
    """The time in seconds by which ``target`` is behind ``reference``: the shift with the smallest difference.

    Least squares, in multiples of ``step``.  This resolves delays below the interval of 33 ms, without the bias towards
    zero of a correlation whose overlap shrinks.
    """
    begin, end = reference[0][0], target[-1][0] - largest
    grid = np.arange(begin, end, step)
    expected = np.interp(grid, [time for time, _ in reference], [value for _, value in reference])
    times, values = [time for time, _ in target], [value for _, value in target]
    shifts = np.arange(-largest / 3, largest, step)
    distances = [np.mean((np.interp(grid + shift, times, values) - expected) ** 2) for shift in shifts]
    return float(shifts[int(np.argmin(distances))])


def errors(log: Log, expected: Sequence[float]) -> tuple[float, float]:
    """RMS and largest difference between a log's values and the expected values at those times."""
    differences = np.array([value for _, value in log]) - np.array(expected)
    return float(np.sqrt(np.mean(differences**2))), float(np.max(np.abs(differences)))
