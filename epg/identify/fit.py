# SPDX-License-Identifier: Apache-2.0
"""Fits a motor of first order to the measured positions by least squares, on simulated positions.

Positions are not differentiated: the difference of two counts says little about a speed.  The unknowns are the first
position, the gain, the time constant, the friction, the delay from a row's duty to its effect, and the first speed if
the motor does not begin at rest.

The problem has at most six unknowns and is smooth, so the Levenberg-Marquardt method with numpy solves it.  Unknowns
are clipped to their bounds.  An unknown at its bound is left out while its gradient points outwards.  The search starts
at the best point of a grid of time constants and frictions, where a linear regression gives position and gain.

The standard errors are those of least squares, times the square root of the residual's correlation time in points.
This time is at least ``_ROUNDED`` if the residual is that of rounding: the rounding errors of a uniform movement repeat
in a pattern, which can shift all values a little and looks like white noise.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

from epg.generator.dataclass import dataclass
from epg.identify.motor import travel
from epg.identify.samples import Samples

MOST_DELAY = 3.0
"""The largest delay, in samples."""
_TAUS, _FRICTIONS = 12, (0.0, 0.15, 0.4)
_ROUNDED = 4.0
_OFFSET, _GAIN, _TAU, _FRICTION, _DELAY, _SPEED = range(6)


@dataclass(frozen=True)
class FittedValue:
    """An identified value with its standard error, in the same unit."""

    value: float
    error: float


@dataclass(frozen=True)
class Fit:
    """A motor that has been identified.

    ``gain`` is the speed per unit of duty; ``friction`` is the duty that just moves the motor; ``delay`` is the time
    from a row of the recording until its duty acts.  ``simulated`` are positions at the samples' times; ``rms`` is that
    of measured - simulated.
    """

    gain: FittedValue
    time_constant: FittedValue
    friction: FittedValue
    delay: FittedValue
    simulated: Any
    rms: float


def fit(samples: Samples, *, dead_zone: bool = False) -> Fit:
    """The motor whose simulated positions are nearest to the measured ones.

    With ``dead_zone``, ``friction`` is the duty below which the motor is not driven at all, and there is no friction.
    """
    import numpy as np

    time, measured = samples.time, samples.position
    step, length = samples.period, float(time[-1] - time[0])
    largest = max(abs(duty) for duty in samples.duties)
    low = np.array([-math.inf, -math.inf, math.log(step / 50.0), 0.0, 0.0, -math.inf])
    high = np.array([math.inf, math.inf, math.log(50.0 * length), largest, MOST_DELAY * step, math.inf])
    fixed = np.array([False, False, False, False, False, samples.at_rest])

    def unit(unknowns: Any) -> Any:
        changes = [change + unknowns[_DELAY] for change in samples.changes]
        changes[0] = samples.changes[0]
        tau, friction, speed = math.exp(unknowns[_TAU]), float(unknowns[_FRICTION]), float(unknowns[_SPEED])
        if dead_zone:
            beyond = [math.copysign(max(abs(duty) - friction, 0.0), duty) for duty in samples.duties]
            return travel(time, changes, beyond, tau, 0.0, speed)
        return travel(time, changes, samples.duties, tau, friction, speed)

    def simulate(unknowns: Any) -> Any:
        return unknowns[_OFFSET] + unknowns[_GAIN] * unit(unknowns)

    points = samples.points
    target = points.of(measured)

    def residual_of(unknowns: Any) -> Any:
        return target - points.of(simulate(unknowns))

    def jacobian(unknowns: Any) -> Any:
        columns = [np.ones(len(target)), points.of(unit(unknowns))]
        steps = [0.0, 0.0, 1e-4, 1e-4 * largest, 1e-2 * step, 1e-4 * largest]
        for at in range(_TAU, _SPEED + 1):
            if fixed[at]:
                columns.append(np.zeros(len(target)))
                continue
            above, below = unknowns.copy(), unknowns.copy()
            above[at] = min(unknowns[at] + steps[at], high[at])
            below[at] = max(unknowns[at] - steps[at], low[at])
            slope = points.of(unit(above) - unit(below)) / (above[at] - below[at])
            columns.append(unknowns[_GAIN] * slope)
        return np.stack(columns, axis=1)

    starts = sorted(_starts(samples, unit, step, length, largest), key=lambda found: float(found[0]))
    best: tuple[float, Any] | None = None
    for start in _different(starts):
        cost, unknowns = _least_squares(residual_of, jacobian, start, low, high, fixed)
        if best is None or cost < best[0]:
            best = cost, unknowns
    assert best is not None
    unknowns = best[1]
    simulated = simulate(unknowns)
    free = ~fixed & (unknowns > low) & (unknowns < high)
    free[_FRICTION] = True  # also at its limit: gain and friction of a single duty cannot be told apart
    slopes = jacobian(unknowns)[:, free]
    errors = np.full(6, 0.0)
    rms = float(np.sqrt(((measured - simulated) ** 2).mean()))
    errors[free] = _errors(slopes, residual_of(unknowns), _ROUNDED if rms < samples.resolution else 1.0)
    tau = math.exp(unknowns[_TAU])
    return Fit(
        gain=FittedValue(float(unknowns[_GAIN]), float(errors[_GAIN])),
        time_constant=FittedValue(tau, tau * float(errors[_TAU])),
        friction=FittedValue(float(unknowns[_FRICTION]), float(errors[_FRICTION])),
        delay=FittedValue(float(unknowns[_DELAY]), float(errors[_DELAY])),
        simulated=simulated,
        rms=rms,
    )


def _starts(
    samples: Samples, unit: Callable[[Any], Any], step: float, length: float, largest: float
) -> list[tuple[float, Any]]:
    """Rough solutions with their sums of squares."""
    import numpy as np

    guesses = []
    speeds = (0.0,) if samples.at_rest else (0.0, samples.speed)
    for tau in np.geomspace(step, length, _TAUS):
        for friction in _FRICTIONS:
            unknowns = np.array([0.0, 1.0, math.log(tau), friction * largest, 0.0, 0.0])
            shape = unit(unknowns)
            around = shape - shape.mean()
            power = float(around @ around)
            gain = float(around @ samples.position) / power if power > 0.0 else 0.0
            if gain == 0.0:
                continue
            for speed in speeds:
                guess = unknowns.copy()
                guess[_GAIN] = gain
                guess[_SPEED] = speed / gain
                curve = gain * unit(guess)
                guess[_OFFSET] = float((samples.position - curve).mean())
                residual = samples.position - curve - guess[_OFFSET]
                guesses.append((float(residual @ residual), guess))
    return guesses


def _different(starts: list[tuple[float, Any]]) -> list[Any]:
    """The best start, and the best one with another time constant, in case the first one leads to a local minimum."""
    first = starts[0][1]
    return [first, *[start for _, start in starts if abs(start[_TAU] - first[_TAU]) > 0.1][:1]]


# One function, because its steps share the state of the search.
def _least_squares(
    residual_of: Callable[[Any], Any],
    jacobian: Callable[[Any], Any],
    start: Any,
    low: Any,
    high: Any,
    fixed: Any,
) -> tuple[float, Any]:
    """The sum of squares and the unknowns of the Levenberg-Marquardt method.

    Reference: K. Madsen, H. B. Nielsen, O. Tingleff, "Methods for Non-Linear Least Squares Problems", 2004, 3.2.
    """
    import numpy as np

    unknowns = np.clip(start, low, high)
    residual = residual_of(unknowns)
    cost = float(residual @ residual)
    damping = 1e-3
    for _ in range(40):
        slopes = jacobian(unknowns)
        gradient = slopes.T @ residual
        held = fixed | ((unknowns <= low) & (gradient < 0.0)) | ((unknowns >= high) & (gradient > 0.0))
        free = ~held
        some = slopes[:, free]
        scale = np.sqrt((some * some).sum(axis=0))
        scale[scale == 0.0] = 1.0
        normal = (some / scale).T @ (some / scale)
        improved = False
        while damping < 1e10:
            change = np.linalg.solve(normal + damping * np.eye(len(scale)), gradient[free] / scale) / scale
            candidate = unknowns.copy()
            candidate[free] += change
            candidate = np.clip(candidate, low, high)
            new = residual_of(candidate)
            new_cost = float(new @ new)
            if new_cost < cost:
                improved = True
                break
            damping *= 5.0
        if not improved:
            break
        gained = (cost - new_cost) / cost
        unknowns, residual, cost = candidate, new, new_cost
        damping = max(damping / 10.0, 1e-12)
        if gained < 1e-8:
            break
    return cost, unknowns


def _errors(slopes: Any, residual: Any, least: float) -> Any:
    """The standard errors of the unknowns with these ``slopes``, for a correlation time of ``least`` or more."""
    import numpy as np

    count, unknowns = slopes.shape
    scale = np.sqrt((slopes * slopes).sum(axis=0))
    scale[scale == 0.0] = 1e-300  # an unknown without effect is unknown
    normal = (slopes / scale).T @ (slopes / scale)
    variance = float(residual @ residual) / max(count - unknowns, 1) * max(_correlation_time(residual), least)
    values, vectors = np.linalg.eigh(normal)
    inverse = ((vectors / np.maximum(values, 1e-15)) * vectors).sum(axis=1)
    return np.sqrt(inverse * variance) / scale


def _correlation_time(residual: Any) -> float:
    """The correlation time of a residual in samples: 1 if it is white."""
    import numpy as np

    around = residual - residual.mean()
    power = float(around @ around)
    if power == 0.0:
        return 1.0
    size = 1 << (2 * len(around) - 1).bit_length()
    spectrum = np.abs(np.fft.rfft(around, size)) ** 2
    correlation = np.fft.irfft(spectrum, size)[: len(around)] / power
    below = np.nonzero(correlation <= 0.0)[0]
    return 1.0 + 2.0 * float(correlation[1 : below[0] if len(below) else len(around)].sum())
