# SPDX-License-Identifier: Apache-2.0
"""The table with the result of a run, for the user."""

from __future__ import annotations

from fractions import Fraction

from epg.quantity import show
from epg.simulate.executable import Statistics
from epg.simulate.result import Result
from epg.simulate.tracking import WindowResult


def format_table(result: Result) -> str:
    """The table as text: counts, times and the errors of each axis, then each limit that did not hold."""
    rows = _run(result.statistics)
    lines = [f"{name:<22}{value}" for name, value in rows]
    if result.windows:
        width = max(8, *(len(window.axis) + 2 for window in result.windows))
        lines += ["", f"{'axis':<{width}}{'window':<16}{'RMS error':>14}{'largest error':>16}{'RMS to ideal':>16}"]
        lines += [_window(window, width) for window in result.windows]
    if result.ending.problem:
        lines += ["", f"FAILED: {result.ending.problem}", f"hint: {result.ending.hint}"][
            : 3 if result.ending.hint else 2
        ]
    failed = [check for check in result.checks if not check.passed]
    if failed:
        lines.append("")
        lines += [f"NOT HELD: {c.text}: {c.value:.4g} {c.unit}".rstrip() + f" (limit {c.limit:g})" for c in failed]
    elif result.checks:
        lines += ["", f"all {len(result.checks)} limits of the scenario hold"]
    return "\n".join(lines)


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
        speed = s.duration / s.wall_time if s.wall_time > 0 else 0.0
        rows.append(("simulated time", f"{s.duration:.3f} s"))
        rows.append(("wall time", f"{s.wall_time:.3f} s ({speed:.0f} x real time)"))
    counted = (
        (s.clamped, "values clamped"),
        (s.setpoints_dropped, "setpoints dropped"),
        (s.setpoint_timeouts, "setpoint timeouts"),
        (s.faults, "faults"),
    )
    if any(number for number, _ in counted):
        rows.append(("events", ", ".join(f"{number} {text}" for number, text in counted if number)))
    if not s.enabled:
        rows.append(("at the end", f"disabled ({s.fault})"))
    return rows


def _window(result: WindowResult, width: int) -> str:
    between = f"{result.window.start:g} ... {result.window.end:g} s"
    rms, largest = (f"{value:.4f} {result.unit}".rstrip() for value in (result.rms, result.largest))
    deviation = "-" if result.deviation is None else f"{result.deviation:.4f} {result.unit}".rstrip()
    return f"{result.axis:<{width}}{between:<16}{rms:>14}{largest:>16}{deviation:>16}"


def _time(seconds: float) -> str:
    return show(Fraction(seconds), "time", digits=3)
