# SPDX-License-Identifier: Apache-2.0
"""``epg simulate``: runs a host executable through a scenario, prints the result, writes the values and a plot."""

from __future__ import annotations

import argparse
import sys
from dataclasses import asdict
from pathlib import Path

from epg.diagnostics import Diagnostics

EXIT_LIMITS = 5
"""The exit status if a limit of the scenario does not hold, or if the run did not end in the expected state."""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "executable", type=Path, metavar="EXECUTABLE", help="a host executable made by epg_add_executable()"
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
    from epg import bootstrap
    from epg.cli.progress import Progress
    from epg.cli.report import to_json
    from epg.simulate import format_table, simulate

    try:
        bootstrap.ensure("plot")
    except bootstrap.MissingPackages as problem:
        sys.stderr.write(f"epg: no plot will be drawn: {problem}\n")
    progress = Progress(quiet=options.json)
    result = simulate(
        options.executable, options.scenario, options.output, realtime=options.realtime, progress=progress
    )
    progress.done()
    diagnostics.items.extend(result.diagnostics)
    if options.json:
        data = {
            "statistics": asdict(result.statistics),
            "windows": [asdict(window) for window in result.windows],
            "checks": [asdict(check) for check in result.checks],
            "ending": asdict(result.ending),
            "passed": result.passed,
            "files": [file.name for file in result.files],
        }
        sys.stdout.write(to_json(data))
    else:
        print(format_table(result))
        kept = [file for file in result.files if file.name.startswith("tracking")]
        print("\nwrote " + ", ".join(str(file) for file in kept))
    return 0 if result.passed else EXIT_LIMITS
