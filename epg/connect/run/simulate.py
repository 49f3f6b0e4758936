# SPDX-License-Identifier: Apache-2.0
"""Simulates a target: builds its program for this computer, and runs it through a scenario, with ``epg simulate``.

>>> # run = SimulationRun(changed=wake_the_page)
>>> # run.start(simulation); run.state()["result"]["passed"]; run.plot
"""

from __future__ import annotations

import hashlib
import json
import math
import os
import sys
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, ClassVar

import epg
from epg.connect.activity import Activity, Outcome, message_of
from epg.connect.build.build_messages import BuildMessage, Messages
from epg.connect.build.build_run import build
from epg.connect.build.plan import make_plan
from epg.connect.run.find_simulation import Simulation
from epg.generator.diagnostics import Diagnostics, UserError
from epg.graph.tracking_picture import draw_tracking
from epg.simulate.load_scenario import load_scenario


class SimulationRun(Activity):
    """One simulation.  ``result`` in its state is None until the program has run to its end.

    ``plot`` is the picture of the finished run; empty before.
    """

    more: ClassVar = {"result": None, "can_try": False}

    def __init__(self, changed: Callable[[], None]) -> None:
        super().__init__(changed)
        self.plot = ""

    def start(self, simulation: Simulation, *, anyway: bool = False) -> None:
        """Builds and runs ``simulation``; ``anyway`` as for :func:`~epg.connect.build.plan.make_plan`."""
        self.begin(lambda: self._simulate(simulation, anyway))

    def _simulate(self, simulation: Simulation, anyway: bool) -> Outcome:
        diagnostics = Diagnostics()
        load_scenario(simulation.scenario, diagnostics)  # reports mistakes before the build
        if diagnostics.has_errors:
            raise UserError(diagnostics)
        outcome, program = build_program(self, simulation, anyway)
        if program is None:
            return outcome
        self.read_messages(Messages((simulation.scenario.parent,)))
        output = Path(os.path.abspath(simulation.job.build_dir or simulation.scenario.parent / "build"))
        answer = _Answer(self.read)
        environment = {**os.environ, "PYTHONUNBUFFERED": "1", "EPG_NO_INSTALL": "1", "EPG_ABSOLUTE_PATHS": "1"}
        command = simulate_command(program, simulation.scenario, output)
        self.run("simulate", command, simulation.scenario.parent, environment, line=answer.read)
        if self.is_cancelled:
            return Outcome("cancelled")
        data = answer.data
        if data is None or "diagnostics" in data:
            found = [message_of(each) for each in data["diagnostics"]] if data is not None else []
            return Outcome("failed", found or self.found_messages())
        self.plot = draw_tracking(output / "tracking.csv", load_scenario(simulation.scenario, Diagnostics()))
        picture = hashlib.sha256(self.plot.encode()).hexdigest()[:16]
        return Outcome("done", outcome.messages, {"result": {**_result(data, output), "picture": picture}})


def simulate_command(program: Path | str, scenario: Path, output: Path) -> tuple[str, ...]:
    """The command that runs ``program`` through ``scenario``, and writes files into ``output``."""
    main = Path(epg.__file__).with_name("__main__.py")
    words = ("simulate", str(program), "--scenario", str(scenario), "--output", str(output), "--json")
    return (sys.executable, str(main), *words)


def commands_of(simulation: Simulation) -> tuple[tuple[str, ...], ...]:
    """The commands that run after the build, to show them to the user."""
    build_dir = make_plan(simulation.job, None, run=False).build
    return (simulate_command(build_dir / simulation.executable, simulation.scenario, build_dir),)


def build_program(run: Activity, simulation: Simulation, anyway: bool) -> tuple[Outcome, Path | None]:
    """Builds the program of a simulation, which is None after a failure.  Zephyr's has a name of its own."""
    outcome, made = build(run, simulation.job, anyway=anyway)
    if outcome.state != "done":
        return outcome, None
    paths = [each.path for each in made]
    program = next((path for path in paths if path.stem == simulation.executable), paths[0] if paths else None)
    if program is None:
        text = f"the build has not made the program '{simulation.executable}'"
        outcome = Outcome("failed", [BuildMessage("error", text, id="simulation-failed")])
    return outcome, program


class _Answer:
    """Takes the JSON object out of the output of ``epg simulate --json``; ``other`` gets the other lines."""

    def __init__(self, other: Callable[[str], None]) -> None:
        self._other = other
        self._lines: list[str] = []
        self.data: dict[str, Any] | None = None

    def read(self, line: str) -> None:
        if not self._lines and line != "{":
            self._other(line)
            return
        self._lines.append(line)
        if line == "}":
            self.data = json.loads("\n".join(self._lines))
            self._lines = []


def _result(data: Mapping[str, Any], output: Path) -> dict[str, Any]:
    """The result for the page.  Values that are not finite are None."""
    statistics = data["statistics"]
    result = {
        "passed": data["passed"],
        "problem": data["ending"]["problem"],
        "hint": data["ending"]["hint"],
        "checks": [{**each, "passed": each["value"] <= each["limit"]} for each in data["checks"]],
        "windows": [
            {
                "axis": each["axis"],
                "unit": each["unit"],
                "start": float(each["window"]["start"]),
                "end": float(each["window"]["end"]),
                "rms": each["rms"],
                "largest": each["largest"],
            }
            for each in data["windows"]
        ],
        "cycles": statistics["cycles"],
        "duration": statistics["duration"],
        "folder": str(output),
        "files": list(data["files"]),
    }
    finite: dict[str, Any] = _finite(result)
    return finite


def _finite(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: _finite(each) for key, each in value.items()}
    if isinstance(value, list):
        return [_finite(each) for each in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value
