# SPDX-License-Identifier: Apache-2.0
"""Judges a run by its scenario: the signals of each axis, their errors, and the limits that must hold."""

from __future__ import annotations

from array import array
from collections.abc import Mapping

from epg.dataclass import dataclass
from epg.simulate.reference import Reference
from epg.simulate.scenario import Scenario
from epg.simulate.tracking import Check, Tracking, WindowResult, check, evaluate, track


@dataclass(frozen=True)
class Judged:
    """The signals of all axes, their errors, and the limits with what was measured."""

    trackings: tuple[Tracking, ...]
    windows: tuple[WindowResult, ...]
    checks: tuple[Check, ...]


def judge(scenario: Scenario, columns: Mapping[str, array[float]], reference: Reference | None) -> Judged:
    """Judges the signals ``columns``, which have the names of the scenario."""
    trackings = tuple(
        track(axis, None if axis.follows_signal else scenario.profiles[axis.setpoint], columns, reference)
        for axis in scenario.axes
    )
    windows = [evaluate(tracking) for tracking in trackings]
    checks = [held for tracking, results in zip(trackings, windows) for held in check(tracking, results)]
    return Judged(trackings, tuple(result for results in windows for result in results), tuple(checks))
