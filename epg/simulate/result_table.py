# SPDX-License-Identifier: Apache-2.0
"""The table with the result of a run, for the user."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fractions import Fraction

from epg.generator.quantity import show
from epg.runs.ending import Ending
from epg.runs.executable import Statistics
from epg.runs.tracking import Check, WindowResult
from epg.simulate.result import SimulationResult
from epg.simulate.run_system import SystemResult, TargetState


def format_table(result: SimulationResult | SystemResult) -> str:
    """The table as text: counts, times and the errors of each axis, then each limit that did not hold."""
    if isinstance(result, SystemResult):
        return _format_system(result)
    lines = [f"{name:<22}{value}" for name, value in _run(result.statistics)]
    return "\n".join([*lines, *_judged(result.windows, result.checks, {"": result.ending})])


def _format_system(result: SystemResult) -> str:
    lines = [f"{name:<22}{value}" for name, value in _times(result.duration, result.wall_time)]
    width = max(len(name) + 2 for name in ("target", *result.targets))
    lines += ["", f"{'target':<{width}}{'cycles':>16}  {'at the end':<28}events"]
    for name, state in result.targets.items():
        end = {"hangs": "hangs", "dead": "dead"}.get(state.state) or _end(state)
        cycles = f"{state.cycles} of {_time(state.period)}"
        lines.append(f"{name:<{width}}{cycles:>16}  {end:<27} {_counts(state)}".rstrip())
    return "\n".join([*lines, *_judged(result.windows, result.checks, result.endings)])


def _judged(windows: Sequence[WindowResult], checks: Sequence[Check], endings: Mapping[str, Ending]) -> list[str]:
    """The errors of each axis, wrong ends of targets, and limits that did not hold."""
    lines = []
    if windows:
        width = max(8, *(len(window.axis) + 2 for window in windows))
        lines += ["", f"{'axis':<{width}}{'window':<16}{'RMS error':>14}{'largest error':>16}{'RMS to ideal':>16}"]
        lines += [_window(window, width) for window in windows]
    for target, ending in endings.items():
        if ending.problem:
            name = f"{target}: " if target else ""
            lines += ["", f"FAILED: {name}{ending.problem}", f"hint: {ending.hint}"][: 3 if ending.hint else 2]
    failed = [check for check in checks if not check.passed]
    if failed:
        lines.append("")
        lines += [f"NOT HELD: {c.text}: {c.value:.4g} {c.unit}".rstrip() + f" (limit {c.limit:g})" for c in failed]
    elif checks:
        lines += ["", f"all {len(checks)} limits of the scenario hold"]
    return lines


def _run(statistics: Statistics) -> list[tuple[str, str]]:
    s = statistics
    rows = [
        ("cycles", f"{s.cycles} of {_time(s.period)}"),
        ("overruns", f"{s.overruns} ({s.missed} ticks missed)"),
        (
            "computation time",
            f"{_time(s.computation_min)} / {_time(s.computation_mean)} / {_time(s.computation_max)} (min / mean / max)",
        ),
    ]
    if s.mode == "realtime":
        jitter = f"{_time(s.lateness_mean)} / {_time(s.lateness_p99)} / {_time(s.lateness_max)} (mean / 99 % / max)"
        rows.append(("lateness of cycles", f"{jitter}, {s.scheduler}"))
        rows.append(("real time", f"{s.duration:.3f} s"))
    else:
        rows += _times(s.duration, s.wall_time)
    if _counts(s):
        rows.append(("events", _counts(s)))
    if not s.enabled:
        rows.append(("at the end", _end(s)))
    return rows


def _times(duration: float, wall_time: float) -> list[tuple[str, str]]:
    speed = duration / wall_time if wall_time > 0 else 0.0
    return [
        ("simulated time", f"{duration:.3f} s"),
        ("wall time", f"{wall_time:.3f} s ({speed:.0f} x real time)"),
    ]


def _counts(state: Statistics | TargetState) -> str:
    """The numbers of events that happened."""
    counted = (
        (state.clamped, "values clamped"),
        (state.setpoints_dropped, "setpoints dropped"),
        (state.setpoint_timeouts, "setpoint timeouts"),
        (state.faults, "faults"),
    )
    return ", ".join(f"{number} {text}" for number, text in counted if number)


def _end(state: Statistics | TargetState) -> str:
    component = f": {state.fault_component}" if state.fault_component else ""
    return "enabled" if state.enabled else f"disabled ({state.fault}{component})"


def _window(result: WindowResult, width: int) -> str:
    between = f"{result.window.start:g} ... {result.window.end:g} s"
    rms, largest = (f"{value:.4f} {result.unit}".rstrip() for value in (result.rms, result.largest))
    deviation = "-" if result.deviation is None else f"{result.deviation:.4f} {result.unit}".rstrip()
    return f"{result.axis:<{width}}{between:<16}{rms:>14}{largest:>16}{deviation:>16}"


def _time(seconds: float) -> str:
    return show(Fraction(seconds), "time", digits=3)
