# SPDX-License-Identifier: Apache-2.0
"""Runs the simulation of a system through a scenario: writes setpoints and failures, runs, evaluates and plots."""

from __future__ import annotations

import json
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

from epg.generator.dataclass import dataclass
from epg.generator.diagnostics import Diagnostics
from epg.runs.ending import Ending, how_it_ended
from epg.runs.executable import run_program
from epg.runs.interface import Interface, check_names, read_interface
from epg.runs.judge import judge
from epg.runs.plot_style import Mark
from epg.runs.recording import Signal, read_table
from epg.runs.reference import load_reference
from epg.runs.scenario import FAILURES, Scenario
from epg.runs.setpoint_file import SetpointRow, failure_lines, setpoint_rows, write_setpoints
from epg.runs.tracking import Check, WindowResult, write_tracking
from epg.simulate.load_scenario import load_scenario
from epg.simulate.marks import SIGNALS, state_marks
from epg.simulate.plot import plot

INPUTS, TRACES = "inputs", "traces"
"""The folders of the files of single targets."""

_PLANT = "plant."
"""The beginning of the names of the signals of the system's plant."""


@dataclass(frozen=True)
class TargetState:
    """A target at the end of a run.  ``state`` is "runs", "hangs" or "dead".  The counts are since its last start."""

    state: str
    period: float
    cycles: int
    clamped: int
    setpoints_dropped: int
    setpoint_timeouts: int
    faults: int
    enabled: bool
    fault: str
    fault_component: str


@dataclass(frozen=True)
class SystemResult:
    """The result of one run.  Times are in seconds.  ``diagnostics`` contains only warnings."""

    name: str
    duration: float
    wall_time: float
    targets: Mapping[str, TargetState]
    endings: Mapping[str, Ending]
    windows: tuple[WindowResult, ...]
    checks: tuple[Check, ...]
    files: tuple[Path, ...]
    diagnostics: Diagnostics

    @property
    def passed(self) -> bool:
        """True if each target ended in the state that the scenario expects, and all limits hold."""
        return not any(ending.problem for ending in self.endings.values()) and all(c.passed for c in self.checks)

    def data(self) -> dict[str, Any]:
        """The result for programs, as JSON holds it."""
        return {
            "system": self.name,
            "duration": self.duration,
            "wall_time": self.wall_time,
            "targets": {name: asdict(state) for name, state in self.targets.items()},
            "windows": [asdict(window) for window in self.windows],
            "checks": [asdict(check) for check in self.checks],
            "endings": {name: asdict(ending) for name, ending in self.endings.items()},
        }


def simulate_system(
    executable: Path, scenario: Path, output: Path, *, progress: Callable[[str], None] = lambda message: None
) -> SystemResult:
    """Runs the program of epg_add_system() through ``scenario`` and evaluates the run.

    Writes into the folder ``output``, which is made if it is missing: ``setpoints.csv``, ``events.csv``,
    ``topics.csv``, ``statistics.json``, ``tracking.csv``, ``traces/<target>.csv``, ``inputs/<target>.csv`` and, if
    matplotlib is installed, ``tracking.png``.  Files of an earlier run are replaced.

    Raises UserError as :func:`epg.simulate.run.simulate` does.
    """
    diagnostics = Diagnostics()
    read = diagnostics.checked(load_scenario(scenario, diagnostics))
    reference = load_reference(read.reference) if read.reference else None
    interface = read_interface(executable)
    check_names(read, interface, diagnostics)
    diagnostics.stop_if_errors()
    output.mkdir(parents=True, exist_ok=True)
    names = ("setpoints.csv", "events.csv", "topics.csv", "statistics.json", "tracking.csv", "tracking.png")
    targets = interface.names["target"]
    files = [output / name for name in (*(f"{TRACES}/{target}.csv" for target in targets), *names)]
    for file in files:
        file.parent.mkdir(exist_ok=True)
        file.unlink(missing_ok=True)

    options = _write_inputs(read, interface, output.resolve())
    progress(f"running {executable.name}: {float(read.duration):g} s of simulated time")
    begin = time.monotonic()
    patience = float(read.duration) * len(targets)
    run_program(executable, options, output.resolve(), patience, realtime=False, progress=progress)
    wall_time = time.monotonic() - begin
    signals = _read_traces(read, targets, output / TRACES)
    progress("evaluating")
    judged = judge(read, signals, reference)
    write_tracking(judged.trackings, output / "tracking.csv")
    marks = [*_failures(read), *(mark for target in targets for mark in state_marks(signals, target))]
    if not plot(judged.trackings, judged.windows, output / "tracking.png", diagnostics, marks):
        files.pop()
    found = json.loads((output / "statistics.json").read_text(encoding="utf-8"))
    states = {name: TargetState(**state) for name, state in found["targets"].items()}
    return SystemResult(
        name=interface.system,
        duration=found["duration"],
        wall_time=wall_time,
        targets=states,
        endings={
            name: _ending(read, name, signals[f"{name}/enabled"].value, state)
            for name, state in states.items()
            if state.state == "runs" or name in read.ends_of
        },
        windows=judged.windows,
        checks=judged.checks,
        files=tuple(files),
        diagnostics=diagnostics,
    )


def _write_inputs(scenario: Scenario, interface: Interface, output: Path) -> list[str]:
    """Writes the files that the program reads, and returns its options."""
    (output / INPUTS).mkdir(exist_ok=True)
    options = ["--duration", repr(float(scenario.duration)), "--trace", str(output / TRACES)]
    options += ["--topics", str(output / "topics.csv"), "--statistics", str(output / "statistics.json")]
    sent: dict[SetpointRow, None] = {}
    for target, topics in interface.topics.items():
        file = output / INPUTS / f"{target}.csv"
        rows = setpoint_rows(scenario, target=target, topics=topics)
        write_setpoints(rows, file)
        options += ["--setpoints", f"{target}={file}"]
        sent |= dict.fromkeys(row for row in rows if not row[1].startswith("$"))
    # The same as a recording of the network: each message once, also if several targets receive it.
    write_setpoints(sorted(sent, key=lambda row: row[:2]), output / "setpoints.csv")
    events = output / "events.csv"
    events.write_text("\n".join([*failure_lines(scenario), ""]), encoding="utf-8", newline="\n")
    return [*options, "--events", str(events)]


def _read_traces(scenario: Scenario, targets: Sequence[str], folder: Path) -> dict[str, Signal]:
    """The signals that the scenario needs, with the names that they have there."""
    wanted = {*scenario.signals, *(f"{target}/{name}" for target in targets for name in SIGNALS)}
    files = [(f"{target}/", folder / f"{target}.csv") for target in targets]
    if any(signal.startswith(_PLANT) for signal in wanted):
        files.append((_PLANT, folder / "plant.csv"))
    signals: dict[str, Signal] = {}
    for prefix, file in files:
        found = read_table(file, lambda name, prefix=prefix: prefix + name in wanted)  # type: ignore[misc]
        signals |= {prefix + name: signal for name, signal in found.signals.items()}
    return signals


def _failures(scenario: Scenario) -> list[Mark]:
    """The failures of the scenario as marks of the plot."""
    failures = [event for event in scenario.events if event.kind in FAILURES]
    return [Mark(float(event.at), f"{event.target}: {event.kind}") for event in failures]


def _ending(scenario: Scenario, target: str, enabled: Sequence[float], state: TargetState) -> Ending:
    """Compares the end of a target with the scenario."""
    if state.state != "runs":
        what = "was dead" if state.state == "dead" else "did not run"
        return Ending(f"the target {what} at the end", f"remove '{target}' from 'ends', or let it restart")
    return how_it_ended(scenario.ends_of.get(target, scenario.ends), enabled, state)
