# SPDX-License-Identifier: Apache-2.0
"""Runs a host executable through a scenario: writes setpoints, runs, evaluates and plots."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from epg.diagnostics import Diagnostics
from epg.simulate.ending import how_it_ended
from epg.simulate.executable import read_statistics, read_trace, run_executable
from epg.simulate.interface import check_names, read_interface
from epg.simulate.load_scenario import load_scenario
from epg.simulate.plot import plot
from epg.simulate.reference import load_reference
from epg.simulate.result import Result
from epg.simulate.setpoints import setpoint_rows, write_setpoints
from epg.simulate.tracking import check, evaluate, track, write_tracking
from epg.source import Span


def simulate(
    executable: Path,
    scenario: Path,
    output: Path,
    *,
    realtime: bool = False,
    progress: Callable[[str], None] = lambda message: None,
) -> Result:
    """Runs ``executable`` through ``scenario`` and evaluates the run.

    Writes into the folder ``output``, which is made if it is missing: ``setpoints.csv``, ``topics.csv``, ``trace.csv``,
    ``statistics.json``, ``tracking.csv`` and, if matplotlib is installed, ``tracking.png``.  Files of an earlier run
    are replaced.  ``progress`` gets short messages, about one each second.

    Raises UserError for a wrong scenario, an executable that fails, or a name that the executable does not have.  A
    limit that does not hold and a run that ends in the wrong state are not errors: see ``Result.passed``.
    """
    diagnostics = Diagnostics()
    read = diagnostics.checked(load_scenario(scenario, diagnostics))
    reference = load_reference(read.reference) if read.reference else None
    if realtime and any(event.kind == "stall" for event in read.events):
        diagnostics.warning("no-stall", Span(str(scenario)), "cycles are stalled in simulated time only")
    check_names(read, read_interface(executable), diagnostics)
    diagnostics.stop_if_errors()
    output.mkdir(parents=True, exist_ok=True)
    names = ("setpoints.csv", "topics.csv", "trace.csv", "statistics.json", "tracking.csv", "tracking.png")
    files = [output / name for name in names]
    for file in files:
        file.unlink(missing_ok=True)

    write_setpoints(setpoint_rows(read, realtime=realtime), files[0])
    run_executable(executable, output, float(read.duration), files[0], realtime=realtime, progress=progress)
    columns = read_trace(output / "trace.csv", ["enabled", *(signal for axis in read.axes for signal in axis.signals)])
    progress("evaluating")
    trackings = [track(axis, read.profiles[axis.setpoint], columns, reference) for axis in read.axes]
    write_tracking(trackings, output / "tracking.csv")
    if not plot(trackings, output / "tracking.png", diagnostics):
        files.pop()
    windows = [evaluate(tracking) for tracking in trackings]
    checks = [held for tracking, results in zip(trackings, windows) for held in check(tracking, results)]
    statistics = read_statistics(output / "statistics.json")
    return Result(
        statistics=statistics,
        ending=how_it_ended(read.ends, columns["enabled"], statistics),
        windows=tuple(result for results in windows for result in results),
        checks=tuple(checks),
        files=tuple(files),
        diagnostics=diagnostics,
    )
