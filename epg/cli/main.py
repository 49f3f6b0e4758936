# SPDX-License-Identifier: Apache-2.0
"""``epg``: parses the command line, runs a subcommand, prints the diagnostics and returns an exit status.

The exit status is:

- 0: success
- 1: mistakes in the user's files
- 2: wrong command line
- 3: a bug in EPG
- 4: something is missing on the computer: a Python package, a program, a folder that can be written
- 5: ``simulate``: a limit does not hold, or the run did not end in the expected state; ``replay``: an output differs
"""

from __future__ import annotations

import argparse
import gc
import importlib
import os
import sys
from collections.abc import Sequence
from contextlib import suppress
from typing import NoReturn

import epg
from epg import bootstrap

COMMANDS = {
    "new": "write a complete project for a model and a target",
    "connect": "connect a model's ports with a target, in the browser or the terminal",
    "check": "check files without generating anything",
    "generate": "write the sources of a target (CMake calls this)",
    "generate-model": "write the library of one model (CMake calls this)",
    "generate-system": "write the simulation of a system (CMake calls this)",
    "generate-all": "write the files of several targets (CMake calls this)",
    "bind": "write bindings for the ports whose names match",
    "ports": "list the ports and parameters of a model",
    "exported": "check an export of 20-sim and print the next steps (EPG's target for 20-sim calls this)",
    "targets": "list targets, component kinds and predefined .tcf files",
    "explain": "show the path from a model port to its pin",
    "graph": "draw the application, the control cycle or the wiring of the board, as SVG",
    "simulate": "run a target or a system through a scenario and check its limits",
    "flash": "write the images of a system to its boards",
    "launch": "write a ROS 2 launch file, or systemd units, for the agents of targets",
    "live": "show the values of a running target, record them, and send it commands",
    "replay": "feed a recording of a target to its host program, and compare the outputs",
    "record": "record the topics of a target or of a system on ROS 2",
    "describe": "write layouts for PlotJuggler and Foxglove with the values of a target",
    "identify": "find a motor's gain, time constant and friction in a recording, for the plant",
    "plot": "compare a recorded run with another one, or with its simulation",
    "find-tools": "find SDKs and programs (CMake calls this)",
    "doctor": "list the tools that this computer has and those that are missing",
    "schema": "write the JSON Schemas of EPG's files, for editors",
}

WITHOUT_PACKAGES = ("doctor", "find-tools")
"""The commands that must run while Python packages are missing.  They install none."""

SHORT = ("check", "generate", "generate-model", "generate-system", "generate-all")
"""The commands that end after a moment.  They run without Python's garbage collector, because almost all of their
objects live as long as they run."""

EXIT_OK, EXIT_MISTAKES, EXIT_USAGE, EXIT_BUG, EXIT_MISSING = range(5)


class MissingProgram(Exception):
    """Something is missing on the computer.  The message says how to install it."""


def main(arguments: Sequence[str] | None = None) -> int:
    """Runs ``epg`` with ``arguments``, or with those of the process.  Returns the exit status."""
    words = sys.argv[1:] if arguments is None else arguments
    command = _command(words)
    if arguments is None and command in SHORT:
        gc.disable()
    if command not in WITHOUT_PACKAGES:
        try:
            bootstrap.ensure()
        except bootstrap.MissingPackages as problem:
            sys.stderr.write(f"{problem}\n")
            return EXIT_MISSING
    parser = _parser(words)
    try:
        options, unknown = parser.parse_known_args(arguments)
        if unknown:
            _refuse(unknown, getattr(options, "parser", parser))
    except SystemExit as stop:
        return int(stop.code or 0)
    if options.cmake_dir or options.examples_dir or options.twenty_sim_dir:
        from epg.data import data_folder

        if options.twenty_sim_dir:
            print(data_folder("integration") / "20-sim" / "EPG")
        else:
            print(data_folder("cmake" if options.cmake_dir else "examples").as_posix())
        return EXIT_OK
    if not options.command:
        parser.print_help()
        return EXIT_USAGE
    return _run(options)


def main_and_exit() -> NoReturn:
    """Runs ``epg`` with the arguments of the process, and ends the process.

    Python frees all objects before it ends, which takes longer than ``python -c pass``.  Short commands leave that to
    the operating system; they have no threads and no temporary files.
    """
    status = main()
    if _command(sys.argv[1:]) in SHORT:
        with suppress(OSError):  # then Python reports it
            sys.stdout.flush()
            sys.stderr.flush()
            os._exit(status)
    sys.exit(status)


def _command(arguments: Sequence[str]) -> str | None:
    """The subcommand: the first word that is not an option."""
    return next((word for word in arguments if not word.startswith("-")), None)


def _parser(arguments: Sequence[str]) -> argparse.ArgumentParser:
    """The parser.  To save time, it has only the subcommand that is the first word, and imports only the chosen one."""
    parser = argparse.ArgumentParser(prog="epg", description="Turns a controller modelled in 20-sim into firmware.")
    parser.add_argument("--version", action="version", version=f"epg {epg.__version__}")
    parser.add_argument("--cmake-dir", action="store_true", help="print the folder of EPGConfig.cmake and exit")
    parser.add_argument("--examples-dir", action="store_true", help="print the folder of the example jiwy and exit")
    parser.add_argument(
        "--20-sim-dir", action="store_true", dest="twenty_sim_dir", help="print the folder to add to 20-sim and exit"
    )
    subparsers = parser.add_subparsers(dest="command", metavar="COMMAND")
    chosen = _command(arguments)
    shown = {chosen: COMMANDS[chosen]} if chosen in COMMANDS and chosen == arguments[0] else COMMANDS
    for name, summary in shown.items():
        sub = subparsers.add_parser(name, help=summary, description=summary[0].upper() + summary[1:] + ".")
        if name == chosen:
            sub.set_defaults(parser=sub)
            sub.add_argument("--json", action="store_true", help="print JSON, for programs")
            importlib.import_module(f"epg.cli.{name.replace('-', '_')}").add_arguments(sub)
    return parser


def _refuse(unknown: Sequence[str], parser: argparse.ArgumentParser) -> None:
    """Exits with the usage of the command, because it does not have the ``unknown`` options."""
    from epg.diagnostics import did_you_mean

    option = unknown[0].partition("=")[0]
    hint = did_you_mean(option, parser._option_string_actions) if option.startswith("--") else ""
    near = f" ({hint})" if hint.startswith("did you mean") else ""
    parser.error(f"unrecognized arguments: {' '.join(unknown)}{near}")


def _run(options: argparse.Namespace) -> int:
    """Runs the chosen subcommand, prints its diagnostics and returns the exit status."""
    from epg.cli.report import format_diagnostics, to_json
    from epg.diagnostics import Diagnostics, UserError

    diagnostics = Diagnostics()
    status: int = EXIT_OK
    try:
        status = (
            importlib.import_module(f"epg.cli.{options.command.replace('-', '_')}").run(options, diagnostics) or EXIT_OK
        )
    except UserError as problem:
        if problem.diagnostics is not diagnostics:
            diagnostics.items.extend(problem.diagnostics)
    except (MissingProgram, bootstrap.MissingPackages) as problem:
        sys.stderr.write(f"epg: {problem}\n")
        return EXIT_MISSING
    except BrokenPipeError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return EXIT_OK
    except KeyboardInterrupt:
        return 130
    except OSError as problem:  # a folder that cannot be written, a full disk
        where = f"{problem.filename}: " if problem.filename else ""
        sys.stderr.write(f"epg: {where}{problem.strerror or problem}\n")
        return EXIT_MISSING
    except Exception:
        sys.stderr.write(format_diagnostics(diagnostics))
        import traceback

        traceback.print_exc()
        sys.stderr.write(f"epg: this is a bug in EPG {epg.__version__}; please report it with the lines above\n")
        return EXIT_BUG
    if getattr(options, "format", None) == "sarif" and status != EXIT_USAGE:
        from pathlib import Path

        from epg.cli.sarif import to_sarif

        sys.stdout.write(to_sarif(diagnostics, Path.cwd()))
    elif diagnostics.items and options.json and diagnostics.has_errors:
        sys.stdout.write(to_json({"diagnostics": [item.data() for item in diagnostics]}))
    sys.stderr.write(format_diagnostics(diagnostics))
    return EXIT_MISTAKES if diagnostics.has_errors else status
