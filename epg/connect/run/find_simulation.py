# SPDX-License-Identifier: Apache-2.0
"""Finds the simulations of a target: those that its project, or the project in the folder ``simulation``, defines.

>>> # simulations_of(job).found[0].scenario  ->  Path("/robot/simulation/scenario.yaml")
"""

from __future__ import annotations

import os
from pathlib import Path

from epg.connect.literal_calls import FILE, LiteralCalls
from epg.connect.projects import Job, find_jobs
from epg.generator.catalog.catalog import load_catalog
from epg.generator.dataclass import dataclass
from epg.generator.diagnostics import Diagnostics
from epg.generator.project import load_configuration

FOLDER = "simulation"
"""The folder in which ``epg new`` writes the project that simulates the target of a board."""
SCENARIO = "scenario.yaml"
_HINT = "docs/simulation.md describes scenarios; epg_add_simulation() adds one to a project"


@dataclass(frozen=True)
class Simulation:
    """A program for this computer, and the scenario to run it through.

    ``job`` builds the program ``executable``.  ``name`` is the name of the simulation's CMake target, or of the
    scenario.
    """

    name: str
    job: Job
    executable: str
    scenario: Path


@dataclass(frozen=True)
class Simulations:
    """The simulations of a target.  If there is none, ``problem`` and ``hint`` are the reason and the remedy."""

    found: tuple[Simulation, ...] = ()
    problem: str = ""
    hint: str = ""


def simulations_of(job: Job) -> Simulations:
    """The simulations of the target of ``job``, those of its own project first."""
    if job.request.system is not None:
        hint = "'epg simulate' runs all of its targets: docs/simulation.md"
        return Simulations(problem="this target is part of a system, which is simulated as a whole", hint=hint)
    jobs = [each for each in (job, *_beside(job)) if _simulates(each)]
    simulations = tuple(simulation for each in jobs for simulation in _of_project(each))
    if simulations:
        return Simulations(simulations)
    if jobs:
        folder = jobs[0].source_dir or jobs[0].request.beside
        problem = f"the project has no scenario, such as {folder / SCENARIO}"
        return Simulations(problem=problem, hint=_HINT)
    problem = f"the project has no folder '{FOLDER}' that builds the controller for this computer"
    return Simulations(problem=problem, hint="'epg new' writes one: docs/new-project.md lists its files")


def _beside(job: Job) -> list[Job]:
    """The same target in the project in the folder ``simulation``."""
    if job.source_dir is None or not (job.source_dir / FOLDER / FILE).is_file():
        return []
    jobs = find_jobs(job.source_dir / FOLDER, Diagnostics())
    wanted = os.path.realpath(job.request.bindings)
    same = [each for each in jobs if os.path.realpath(each.request.bindings) == wanted]
    return same or [each for each in jobs if each.request.name == job.request.name]


def _simulates(job: Job) -> bool:
    """True if the target of ``job`` is a program for this computer."""
    catalog = load_catalog(job.request.roots, Diagnostics())
    configuration = load_configuration(job.request, catalog, Diagnostics())
    return configuration is not None and configuration.target.platform.simulates_plant


def _of_project(job: Job) -> list[Simulation]:
    """The simulations in simulated time that calls of epg_add_simulation() add; else that of ``scenario.yaml``."""
    folder = job.source_dir or job.request.beside
    simulations = []
    for call in LiteralCalls(folder).calls:
        texts = [word.text for word in call.words]
        if call.name != "epg_add_simulation" or "REALTIME" in texts or None in texts:
            continue
        values = dict(zip(texts[1::2], texts[2::2]))
        executable, scenario = values.get("EXECUTABLE"), values.get("SCENARIO")
        if executable in job.executables and executable and scenario:
            simulations.append(Simulation(texts[0] or "", job, executable, call.folder / scenario))
    if not simulations and job.executables and (folder / SCENARIO).is_file():
        simulations.append(Simulation(Path(SCENARIO).stem, job, job.executables[0], folder / SCENARIO))
    return simulations
