# SPDX-License-Identifier: Apache-2.0
"""``epg simulate``: runs a target or a system through a scenario, prints the result, writes the values and a plot."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from typing import TYPE_CHECKING

from epg.cli.system import is_system
from epg.generator.diagnostics import Diagnostics
from epg.generator.source import Span

if TYPE_CHECKING:
    from epg.cli.progress import ProgressLine
    from epg.simulate.result import SimulationResult
    from epg.simulate.run_system import SystemResult

EXIT_LIMITS = 5
"""The exit status if a limit of the scenario does not hold, or if the run did not end in the expected state."""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "executable",
        type=Path,
        metavar="EXECUTABLE",
        help="a host executable made by epg_add_executable(), a simulation made by epg_add_system(), or a system "
        "(*.system.yaml), whose simulation is built",
    )
    parser.add_argument("--scenario", required=True, type=Path, metavar="FILE", help="setpoints, events and limits")
    parser.add_argument(
        "--output",
        type=Path,
        default=Path(),
        metavar="FOLDER",
        help="folder for the results; default: the current folder",
    )
    parser.add_argument("--realtime", action="store_true", help="run in real time instead of simulated time")


def run(options: argparse.Namespace, diagnostics: Diagnostics) -> int:
    from epg.cli.progress import ProgressLine
    from epg.cli.report import to_json
    from epg.generator import bootstrap
    from epg.simulate import format_table

    try:
        bootstrap.ensure("plot")
    except bootstrap.MissingPackages as problem:
        sys.stderr.write(f"epg: no plot will be drawn: {problem}\n")
    progress = ProgressLine(quiet=options.json)
    try:
        result = _simulate(options, diagnostics, progress)
    finally:
        progress.done()
    diagnostics.items.extend(result.diagnostics)
    if options.json:
        data = result.data()
        data |= {
            "passed": result.passed,
            "files": [file.relative_to(options.output).as_posix() for file in result.files],
        }
        sys.stdout.write(to_json(data))
    else:
        print(format_table(result))
        kept = [file for file in result.files if file.name.startswith("tracking")]
        print("\nwrote " + ", ".join(str(file) for file in kept))
    return 0 if result.passed else EXIT_LIMITS


def _simulate(
    options: argparse.Namespace, diagnostics: Diagnostics, progress: ProgressLine
) -> SimulationResult | SystemResult:
    """Runs the program; before this, the program of a system's file is built."""
    from epg.runs.interface import read_interface
    from epg.simulate import load_scenario, simulate, simulate_system

    executable: Path = options.executable
    if is_system(executable):
        _refuse_realtime(options, diagnostics)
        load_scenario(options.scenario, diagnostics)  # reports mistakes before the build
        from epg.cli.build_simulation import build_simulation

        executable = build_simulation(executable, options.output, diagnostics, progress)
    if not read_interface(executable).system:
        return simulate(executable, options.scenario, options.output, realtime=options.realtime, progress=progress)
    _refuse_realtime(options, diagnostics)
    diagnostics.stop_if_errors()
    return simulate_system(executable, options.scenario, options.output, progress=progress)


def _refuse_realtime(options: argparse.Namespace, diagnostics: Diagnostics) -> None:
    """Reports ``--realtime``, which a system does not have."""
    if options.realtime:
        hint = "start the host programs of its targets for real time"
        message = "a system is simulated in simulated time only"
        diagnostics.error("needs-one-target", Span.of_argument("--realtime"), message, hint=hint)
