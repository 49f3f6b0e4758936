# SPDX-License-Identifier: Apache-2.0
"""Judges a run by its scenario: the signals of each axis, their errors, and the limits that must hold."""

from __future__ import annotations

from collections.abc import Mapping

from epg.generator.dataclass import dataclass
from epg.runs.recording import Signal
from epg.runs.reference import Reference
from epg.runs.scenario import Scenario
from epg.runs.tracking import Check, Tracking, WindowResult, check, evaluate, track


@dataclass(frozen=True)
class Judged:
    """The signals of all axes, their errors, and the limits with what was measured."""

    trackings: tuple[Tracking, ...]
    windows: tuple[WindowResult, ...]
    checks: tuple[Check, ...]


def judge(scenario: Scenario, signals: Mapping[str, Signal], reference: Reference | None) -> Judged:
    """Judges ``signals``, which have the names of the scenario."""
    trackings = tuple(
        track(axis, None if axis.follows_signal else scenario.profiles[axis.setpoint], signals, reference)
        for axis in scenario.axes
    )
    windows = [evaluate(tracking) for tracking in trackings]
    checks = [held for tracking, results in zip(trackings, windows) for held in check(tracking, results)]
    return Judged(trackings, tuple(result for results in windows for result in results), tuple(checks))
