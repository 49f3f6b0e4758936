# SPDX-License-Identifier: Apache-2.0
"""The part of a recording from which a motor can be identified: one movement, free of end stops and encoder resets.

A recording has positions at sampling times.  The duty of a row acts until the next row.  The longest part is used that
has none of these:

- a jump of the position, where a controller has reset the encoder;
- a time at an end stop: the motor is driven as strongly as while it moved, and its position does not change;
- missing rows during which the duty has changed.

Of a part with more than ``MOST_ROWS`` rows, those are used in which the speed changes most: a simulation from the first
position departs from the measured curve in the course of time, because no motor is exactly one of first order.

The rest before and after the movement is left out, except for a tenth of its length.

Most of the error of a counted position is that of rounding, and it is the same until the next count.  The fit
therefore compares only *points*: the mean of two rows between which the count has changed, and one row of each rest.
The error of the first is at most the way of half a period, the errors are independent, and a long rest has no more
weight than a short one.
"""

from __future__ import annotations

from itertools import pairwise
from typing import Any, NamedTuple

from epg.generator.dataclass import dataclass

FEWEST_ROWS, MOST_ROWS = 30, 2500
_PAD = 0.1  # rest that is kept on both sides, as a share of the movement
_STILL = 10  # samples without a count that are a rest
_GAP = 2.5  # sampling periods


class SamplePairs(NamedTuple):
    """Each point is the mean of the rows ``first[i]`` and ``second[i]``."""

    first: Any
    second: Any

    def of(self, rows: Any) -> Any:
        return 0.5 * (rows[self.first] + rows[self.second])


@dataclass(frozen=True)
class Samples:
    """``position`` at ``time`` (s), as arrays of numpy.  ``duties[i]`` acts from ``changes[i]`` on.

    ``period`` is the time between two samples.  ``resolution`` is the smallest change of the position, and ``counted``
    is true if all changes are multiples of it.  ``moved`` is the distance between the extreme positions.  ``at_rest``
    is true if the motor rests at the begin; otherwise ``speed`` is a guess of its first speed.  ``stop`` is the first
    time at an end stop, ``jump`` that of the first reset.
    """

    time: Any
    position: Any
    duty: Any
    points: SamplePairs
    changes: list[float]
    duties: list[float]
    period: float
    resolution: float
    counted: bool
    moved: float
    at_rest: bool
    speed: float
    stop: float | None
    jump: float | None

    @property
    def counts(self) -> float:
        """The distance in steps of the resolution."""
        return self.moved / self.resolution if self.resolution > 0.0 else 0.0


def samples_of(time: Any, position: Any, duty: Any) -> Samples:
    """The longest usable part of a recording with at least two rows."""
    import numpy as np

    period = float(np.median(np.diff(time)))
    steps = np.abs(np.diff(position))
    # Positions in a recording are rounded to the precision of float.
    noise = 1e-6 * float(np.abs(position).max() + np.ptp(position))
    real = steps[steps > noise]
    resolution = _resolution(real)
    stops = _stops(position, duty, resolution)
    jumps = _jumps(steps / np.maximum(np.diff(time) / period, 1.0), resolution)
    gaps = np.nonzero((np.diff(time) > _GAP * period) & (np.diff(duty) != 0.0))[0] + 1
    stopped = float(time[stops[0][0]]) if stops else None
    jumped = float(time[min(jumps)]) if jumps else None
    begin, end = _longest(position, {*jumps, *gaps.tolist()}, stops)
    begin, end = _without_rest(position, duty, begin, end, resolution)
    begin, end = _liveliest(position, begin, end)
    time, position, duty = time[begin:end], position[begin:end], duty[begin:end]
    changed = np.concatenate(([0], np.nonzero(np.diff(duty))[0] + 1))
    moves = np.abs(position - position[0]) > 0.5 * resolution
    first = int(moves.argmax()) if moves.any() else len(moves)
    driven = int((duty != 0.0).argmax())
    head = min(len(time), max(_STILL, 2 + first))
    return Samples(
        time=time,
        position=position,
        duty=duty,
        points=_points(position, resolution),
        changes=[float(time[at]) for at in changed],
        duties=[float(duty[at]) for at in changed],
        period=period,
        resolution=resolution,
        counted=_counted(real, resolution),
        moved=float(np.ptp(position)),
        at_rest=driven >= _STILL and first >= driven,
        speed=float(position[head - 1] - position[0]) / max(float(time[head - 1] - time[0]), period) if head > 1 else 0,
        stop=stopped,
        jump=jumped,
    )


def _counted(steps: Any, resolution: float) -> bool:
    """True if almost all steps are multiples of the resolution."""
    import numpy as np

    if not len(steps):
        return False
    fractions = np.abs(steps / resolution - np.round(steps / resolution))
    return bool((fractions < 0.05).mean() > 0.9)


def _longest(position: Any, breaks: set[int], stops: list[tuple[int, int]]) -> tuple[int, int]:
    """The part with the longest path that has no break and no time at an end stop; the whole if there is none."""
    edges = sorted({0, len(position), *breaks, *(edge for stop in stops for edge in stop)})
    parts = [(a, b) for a, b in pairwise(edges) if not any(begin <= a < end for begin, end in stops)]
    return max(parts, key=lambda part: _worth(position[part[0] : part[1]]), default=(0, len(position)))


def _points(position: Any, resolution: float) -> SamplePairs:
    import numpy as np

    moved = np.nonzero(np.abs(np.diff(position)) > 0.5 * resolution)[0] + 1
    runs = [0, *moved.tolist(), len(position)]
    lengths = np.diff(runs)
    rests = []
    for at, length in enumerate(lengths.tolist()):
        beside = [int(lengths[other]) for other in (at - 1, at + 1) if 0 <= other < len(lengths)]
        if length > max(_STILL, 4 * min(beside, default=0)):
            rests.append(runs[at] + length // 2)
    first = np.array([*(moved - 1), *rests], dtype=int)
    order = np.argsort(first, kind="stable")
    second = np.array([*moved, *rests], dtype=int)
    return SamplePairs(first[order], second[order])


def _resolution(steps: Any) -> float:
    """The smallest step, as the mean of all small steps: a single one is rounded."""
    import numpy as np

    if not len(steps):
        return 0.0
    least = float(steps.min())
    small = steps[steps < 8.5 * least]
    return float(small.sum() / np.round(small / least).sum())


def _liveliest(position: Any, begin: int, end: int) -> tuple[int, int]:
    """The rows with the largest variance of the speed."""
    import numpy as np

    if end - begin <= MOST_ROWS:
        return begin, end
    speed = position[begin + _STILL : end] - position[begin : end - _STILL]
    sums, squares = (np.concatenate(([0.0], np.cumsum(each))) for each in (speed, speed * speed))
    size = MOST_ROWS - _STILL
    mean = (sums[size:] - sums[:-size]) / size
    first = begin + int(((squares[size:] - squares[:-size]) / size - mean * mean).argmax())
    return first, first + MOST_ROWS


def _worth(position: Any) -> float:
    """The path of a part: the sum of all movements."""
    import numpy as np

    return float(np.abs(np.diff(position)).sum())


def _jumps(paces: Any, resolution: float) -> set[int]:
    """The rows before which the position jumps.  ``paces`` are the ways per period from each row to the next one.

    A jump is much faster than the movement before and after.  A motor that moves on while rows are missing does not
    jump.
    """
    import numpy as np

    around = np.zeros(len(paces))
    for shift in (-3, -2, -1, 1, 2, 3):
        beside = np.roll(paces, shift)
        beside[: max(shift, 0)] = 0.0
        beside[len(paces) + min(shift, 0) :] = 0.0
        around = np.maximum(around, beside)
    return set((np.nonzero(paces > 10.0 * around + 10.5 * resolution)[0] + 1).tolist())


def _stops(position: Any, duty: Any, resolution: float) -> list[tuple[int, int]]:
    """The rows from and to which the motor is at an end stop, although it is driven."""
    import numpy as np

    result = []
    signs = np.sign(duty)
    edges = [0, *(np.nonzero(np.diff(signs))[0] + 1).tolist(), len(duty)]
    for begin, end in pairwise(edges):
        if signs[begin] == 0.0 or end - begin < 2 * _STILL:
            continue
        last = end - 1
        near = np.abs(position[begin:end] - position[last]) <= 2.1 * resolution
        away = np.nonzero(~near)[0]
        arrival = begin + (int(away[-1]) + 1 if len(away) else 0)
        if arrival == begin:  # it has not moved at all: not a stop that it has reached
            continue
        still = np.nonzero(np.abs(np.diff(position[begin:end])) > 0.5 * resolution)[0]
        moving = [int(at) for at in still if begin + int(at) < arrival]
        pace = float(np.median(np.diff(moving))) if len(moving) > 1 else float(arrival - begin)
        strength = float(np.median(np.abs(duty[begin:arrival])))
        pressed = np.abs(duty[arrival:end]) >= 0.5 * strength
        if float(pressed.sum()) >= max(2.0 * _STILL, 8.0 * pace) and pressed.mean() > 0.5:
            result.append((arrival, end))
    return result


def _without_rest(position: Any, duty: Any, begin: int, end: int, resolution: float) -> tuple[int, int]:
    """The part without most of the rest on both sides.  A motor that is driven is not at rest."""
    import numpy as np

    moved = np.abs(np.diff(position[begin:end])) > 0.5 * resolution
    active = np.nonzero(moved | (duty[begin : end - 1] != 0.0) | (np.diff(duty[begin:end]) != 0.0))[0]
    if not len(active):
        return begin, end
    first, last = begin + int(active[0]), begin + int(active[-1]) + 1
    pad = max(2 * _STILL, int(_PAD * (last - first)))
    return max(begin, first - pad), min(end, last + pad + 1)
