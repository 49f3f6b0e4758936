# SPDX-License-Identifier: Apache-2.0
"""Compares a running target with its simulation: the same setpoints since it was enabled, and the signals of both.

>>> # run = ComparisonRun(changed=wake_the_page)
>>> # run.start(simulation, live.driven(), by=["inputs.setpoint_pan"]); run.state()["result"]; run.compared
"""

from __future__ import annotations

import math
import os
import time
from collections.abc import Callable, Sequence
from fractions import Fraction
from pathlib import Path
from typing import Any, ClassVar

from epg.connect.activity import Activity, Outcome
from epg.connect.build.build_messages import BuildMessage
from epg.connect.build.plan import make_plan
from epg.connect.run.find_simulation import Simulation
from epg.connect.run.simulate import build_program
from epg.generator import bootstrap
from epg.generator.dataclass import dataclass
from epg.runs.compare import Comparison, compare
from epg.runs.recording import Row, read_table, signals_of
from epg.runs.setpoint_file import write_setpoints

DURATION = 60
"""Seconds after enabling that are simulated and compared."""
CLOCKS = 0.1
"""Seconds by which the time of a setpoint, as EPG knows it, can differ from that of its control cycle."""
POINTS = 2000
"""The largest number of points of a curve for the page."""


@dataclass(frozen=True)
class Driven:
    """The motion of a target since it was enabled.  Times are in seconds since then.

    ``setpoints`` are time, name and value of each setpoint that the page has sent.  ``changed`` are the parameters that
    were changed in the target since its build.
    """

    names: tuple[str, ...]
    rows: Sequence[Row]
    setpoints: Sequence[tuple[float, str, float]]
    changed: tuple[str, ...]


class ComparisonRun(Activity):
    """One comparison.  ``compared`` has the curves for the page when it is done; None before."""

    more: ClassVar = {"result": None, "can_try": False}

    def __init__(self, changed: Callable[[], None]) -> None:
        super().__init__(changed)
        self.compared: dict[str, Any] | None = None

    def start(self, simulation: Simulation, driven: Driven, by: Sequence[str], *, anyway: bool = False) -> None:
        """Builds and runs ``simulation`` with the setpoints of ``driven``.  ``by``: the inputs that get setpoints."""
        self.begin(lambda: self._compare(simulation, driven, by, anyway))

    def _compare(self, simulation: Simulation, driven: Driven, by: Sequence[str], anyway: bool) -> Outcome:
        try:
            bootstrap.ensure("plot")
        except bootstrap.MissingPackages as problem:
            return Outcome("failed", [BuildMessage("error", str(problem), id="missing-packages")])
        outcome, program = build_program(self, simulation, anyway)
        if program is None:
            return outcome
        folder = _folder(simulation)
        folder.mkdir(parents=True, exist_ok=True)
        rows = [(Fraction(time), name, value) for time, name, value in driven.setpoints if time < DURATION]
        write_setpoints([(Fraction(0), "$enable", 1.0), *rows], folder / "setpoints.csv")
        status = self.run("simulate", _command(program, folder), folder, os.environ)
        if self.is_cancelled:
            return Outcome("cancelled")
        if status != 0:
            text = "\n".join([f"'{program.name}' ended with status {status}", *self.lines(0)[-3:]])
            return Outcome("failed", [BuildMessage("error", text, id="simulation-failed")])
        self.compared = _compared(driven, folder / "trace.csv", by)
        return Outcome("done", outcome.messages, {"result": {"number": time.time_ns(), "changed": driven.changed}})


def comparison_commands(simulation: Simulation) -> tuple[tuple[str, ...], ...]:
    """The commands that run after the build, to show them to the user."""
    build_dir = make_plan(simulation.job, None, run=False).build
    return (_command(build_dir / simulation.executable, _folder(simulation)),)


def _folder(simulation: Simulation) -> Path:
    return Path(os.path.abspath(make_plan(simulation.job, None, run=False).build / "live"))


def _command(program: Path, folder: Path) -> tuple[str, ...]:
    files = (f"--setpoints={folder / 'setpoints.csv'}", f"--trace={folder / 'trace.csv'}")
    return (str(program), "--quiet", f"--duration={DURATION}", *files)


def _compared(driven: Driven, trace: Path, by: Sequence[str]) -> dict[str, Any]:
    """The curves of both, aligned by the setpoints, with the differences of each signal."""
    simulated = read_table(trace, driven.names.__contains__).signals
    target = signals_of(driven.names, (row for row in driven.rows if row.time <= DURATION))
    pairs = {name: name for name in driven.names if name in simulated}
    chosen = {name: name for name in by if name in pairs and len(set(target[name].value)) > 1}
    comparison = compare(target, simulated, pairs, "correlation" if chosen else "none", chosen)
    if abs(comparison.shift) > CLOCKS:
        comparison = compare(target, simulated, pairs, "none", {})
    return _shown(comparison)


def _shown(comparison: Comparison) -> dict[str, Any]:
    times = [float(time) for time in comparison.pairs[0].time] if comparison.pairs else []
    step = -(-len(times) // POINTS) or 1
    return {
        "shift": comparison.shift,
        "times": [round(time, 6) for time in times[::step]],
        "signals": [
            {
                "name": pair.name,
                "rms": _finite(pair.rms),
                "largest": _finite(pair.largest),
                "target": [_finite(value) for value in pair.run[::step]],
                "simulation": [_finite(value) for value in pair.reference[::step]],
            }
            for pair in comparison.pairs
        ],
    }


def _finite(value: float) -> float | None:
    return float(value) if math.isfinite(value) else None
