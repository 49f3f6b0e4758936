# SPDX-License-Identifier: Apache-2.0
"""Runs a host executable through a scenario: writes setpoints, runs, evaluates and plots."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from epg.generator.diagnostics import Diagnostics
from epg.generator.source import Span
from epg.runs.ending import how_it_ended
from epg.runs.executable import fail, read_statistics, run_executable
from epg.runs.interface import check_names, read_interface
from epg.runs.judge import judge
from epg.runs.recording import read_table
from epg.runs.reference import load_reference
from epg.runs.setpoint_file import setpoint_rows, write_setpoints
from epg.runs.tracking import write_tracking
from epg.simulate.load_scenario import load_scenario
from epg.simulate.marks import SIGNALS, state_marks
from epg.simulate.plot import plot
from epg.simulate.result import SimulationResult


def simulate(
    executable: Path,
    scenario: Path,
    output: Path,
    *,
    realtime: bool = False,
    progress: Callable[[str], None] = lambda message: None,
) -> SimulationResult:
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
    interface = read_interface(executable)
    if interface.system:
        fail(executable, f"'{executable.name}' is the simulation of a system", "call simulate_system()")
    check_names(read, interface, diagnostics)
    diagnostics.stop_if_errors()
    output.mkdir(parents=True, exist_ok=True)
    names = ("setpoints.csv", "topics.csv", "trace.csv", "statistics.json", "tracking.csv", "tracking.png")
    files = [output / name for name in names]
    for file in files:
        file.unlink(missing_ok=True)

    write_setpoints(setpoint_rows(read, realtime=realtime), files[0])
    run_executable(executable, output, float(read.duration), files[0], realtime=realtime, progress=progress)
    signals = read_table(output / "trace.csv", {*SIGNALS, *read.signals}.__contains__).signals
    progress("evaluating")
    judged = judge(read, signals, reference)
    write_tracking(judged.trackings, output / "tracking.csv")
    if not plot(judged.trackings, judged.windows, output / "tracking.png", diagnostics, state_marks(signals)):
        files.pop()
    statistics = read_statistics(output / "statistics.json")
    return SimulationResult(
        statistics=statistics,
        ending=how_it_ended(read.ends, signals["enabled"].value, statistics),
        windows=judged.windows,
        checks=judged.checks,
        files=tuple(files),
        diagnostics=diagnostics,
    )
