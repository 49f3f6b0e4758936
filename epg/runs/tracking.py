# SPDX-License-Identifier: Apache-2.0
"""Evaluates how well each axis followed its setpoint."""

from __future__ import annotations

import math
from array import array
from bisect import bisect_left, bisect_right
from collections.abc import Mapping, Sequence
from pathlib import Path

from epg.generator.dataclass import dataclass
from epg.runs.csv_file import CsvFile
from epg.runs.recording import Row, Signal
from epg.runs.reference import Reference
from epg.runs.scenario import Axis, Profile, Window


@dataclass(frozen=True)
class Tracking:
    """The signals of one axis, with one value for each control cycle.

    ``time`` is in seconds.  ``reference`` is NaN during homing.  It is None if the scenario does not have a reference.
    """

    axis: Axis
    time: Sequence[float]
    setpoint: Sequence[float]
    position: Sequence[float]
    reference: Sequence[float] | None
    duty: Sequence[float] | None


@dataclass(frozen=True)
class WindowResult:
    """The errors in one window, in the unit of the axis.

    ``rms`` and ``largest`` are of position - setpoint.  ``deviation`` is the RMS of position - reference, or None.
    """

    axis: str
    unit: str
    window: Window
    rms: float
    largest: float
    deviation: float | None

    @property
    def held(self) -> bool:
        """True if the errors are within the limits of the window."""
        limits = (self.rms, self.window.rms), (self.largest, self.window.largest)
        return all(limit is None or value <= limit for value, limit in limits)


@dataclass(frozen=True)
class Check:
    """A limit of the scenario and the measured value.  A value that is not finite does not pass."""

    text: str
    value: float
    limit: float
    unit: str

    @property
    def passed(self) -> bool:
        return self.value <= self.limit


def track(axis: Axis, profile: Profile | None, signals: Mapping[str, Signal], reference: Reference | None) -> Tracking:
    """The signals of ``axis`` from traces, at the control cycles of the target whose signal is the position.

    The setpoint is the continuous profile, not the last value that was sent.  It is a signal if ``profile`` is None.
    """
    time = signals[axis.position].time
    setpoint = signals[axis.setpoint].at(time) if profile is None else array("d", (profile.value(t) for t in time))
    ideal: array[float] | None = None
    if reference is not None:
        begin = bisect_left(time, axis.homing.until) if axis.homing else 0
        ideal = array("d", [math.nan] * begin)
        ideal.extend(reference(axis.name, time[begin:], setpoint[begin:]))
    duty = signals[axis.duty].at(time) if axis.duty else None
    return Tracking(axis, time, setpoint, signals[axis.position].value, ideal, duty)


def evaluate(tracking: Tracking) -> list[WindowResult]:
    """The RMS and the largest error in each window of the axis.  Both are NaN for a window without a control cycle."""
    results = []
    for window in tracking.axis.windows:
        inside = slice(bisect_left(tracking.time, window.start), bisect_right(tracking.time, window.end))
        position = tracking.position[inside]
        errors = [p - s for p, s in zip(position, tracking.setpoint[inside])]
        deviation = None
        if tracking.reference is not None:
            deviations = [p - r for p, r in zip(position, tracking.reference[inside]) if not math.isnan(r)]
            deviation = _rms(deviations) if deviations else None
        largest = max(map(abs, errors)) if errors else math.nan
        results.append(WindowResult(tracking.axis.name, tracking.axis.unit, window, _rms(errors), largest, deviation))
    return results


def check(tracking: Tracking, results: Sequence[WindowResult]) -> list[Check]:
    """The checks of all limits of one axis."""
    axis = tracking.axis
    checks = []
    for result in results:
        between = f"from {result.window.start:g} s to {result.window.end:g} s"
        if result.window.rms is not None:
            checks.append(Check(f"{axis.name}: RMS error {between}", result.rms, result.window.rms, axis.unit))
        if result.window.largest is not None:
            limit = result.window.largest
            checks.append(Check(f"{axis.name}: largest error {between}", result.largest, limit, axis.unit))
    homing = axis.homing
    if homing is not None:
        count = bisect_left(tracking.time, homing.until)
        if homing.duty is not None and tracking.duty is not None:
            largest = max(map(abs, tracking.duty[:count]), default=math.nan)
            checks.append(Check(f"{axis.name}: duty while homing", largest, homing.duty, ""))
        if homing.position is not None:
            at = min(count, len(tracking.time) - 1)
            distance = abs(tracking.position[at] - tracking.setpoint[at]) if tracking.time else math.nan
            checks.append(
                Check(f"{axis.name}: distance from setpoint after homing", distance, homing.position, axis.unit)
            )
    return checks


def _rms(values: Sequence[float]) -> float:
    return math.sqrt(math.fsum(value * value for value in values) / len(values)) if values else math.nan


def write_tracking(trackings: Sequence[Tracking], path: Path) -> None:
    """Writes a CSV file for spreadsheets: time, then setpoint, reference, position and duty of each axis.

    If targets of a system have cycles at different times, an axis has values at those of its target only.
    """
    names: list[str] = []
    columns: list[Sequence[float]] = []
    times = sorted({time for tracking in trackings for time in tracking.time})
    for tracking in trackings:
        signals = {"setpoint": tracking.setpoint, "reference": tracking.reference}
        for name, column in (signals | {"position": tracking.position, "duty": tracking.duty}).items():
            if column is not None:
                names.append(f"{tracking.axis.name}_{name}")
                columns.append(_spread(tracking.time, column, times))
    with CsvFile(path, names, "%s", "%s") as file:
        rows = zip(times, *columns)
        file.write(Row(time, ["" if math.isnan(value) else value for value in row]) for time, *row in rows)


def _spread(own: Sequence[float], values: Sequence[float], times: Sequence[float]) -> Sequence[float]:
    """``values``, which belong to the times ``own``, at all ``times``; NaN at the other ones."""
    if len(own) == len(times):
        return values
    known = dict(zip(own, values))
    return [known.get(time, math.nan) for time in times]
