# SPDX-License-Identifier: Apache-2.0
"""``epg generate-system``: writes the sources of the simulation of a system.  CMake calls it while it configures."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from epg.cli.arguments import user_roots
from epg.cli.output import add_output_arguments, update_folder, write_warnings
from epg.generator.diagnostics import Diagnostics


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("name", help="name of the program")
    parser.add_argument("--system", required=True, type=Path, metavar="FILE", help="the system (*.system.yaml)")
    parser.add_argument(
        "--target", metavar="TARGET", help="write the part of this target, <name>_<target>; default: the program"
    )
    add_output_arguments(parser)
    parser.add_argument("--caller", metavar="CMAKELISTS", help=argparse.SUPPRESS)


def run(options: argparse.Namespace, diagnostics: Diagnostics) -> int:
    from epg.cli.system import system_of, target_of
    from epg.generator.emit.cmake import PathNames
    from epg.system.check_system import check_system
    from epg.system.simulation import part_outputs, simulation_outputs

    system, caller = system_of(options, diagnostics)
    names = PathNames(options.source_dir)
    if options.target is None:
        checked = diagnostics.checked(check_system(system, user_roots(), diagnostics))
        files = simulation_outputs(checked, options.name, names, diagnostics)
    else:
        target = target_of(system, options.target, caller, diagnostics)
        files = part_outputs(system, target, options.name, user_roots(), names, diagnostics)
    update_folder(options.output, files, sys.stdout if options.json else None)
    write_warnings(options.warnings, diagnostics)
    return 0
