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
from functools import cache
from typing import TYPE_CHECKING, Any, NoReturn

import epg
from epg.generator import bootstrap

if TYPE_CHECKING:
    from epg.generator.diagnostics import Diagnostics

COMMANDS = {
    "new": "write a complete project for a model and a target",
    "connect": "connect a model's ports with a target, in the browser or the terminal",
    "check": "check files without generating anything",
    "generate": "write the sources of a target (CMake calls this)",
    "generate-model": "write the library of one model (CMake calls this)",
    "generate-system": "write the simulation of a system (CMake calls this)",
    "model-variables": "find the variables of a model in its object files (CMake calls this)",
    "link-model": "compile and link a model alone (CMake calls this)",
    "generate-all": "write the files of several targets (CMake calls this)",
    "bind": "write bindings for the ports whose names match",
    "ports": "list the ports and parameters of a model",
    "exported": "check an export of 20-sim and print the next steps (EPG's target for 20-sim calls this)",
    "targets": "list targets, component kinds and predefined .tcf files",
    "migrate": "note what files mean now that they did not mean in earlier versions",
    "explain": "show the path from a model port to its pin, or explain a message by its id",
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

_BUILD = "CMake builds a project: cmake -S . -B build, then cmake --build build"
INSTEAD = {
    **dict.fromkeys(("build", "compile", "make", "all"), _BUILD),
    "configure": "CMake configures a project: cmake -S . -B build",
    "clean": "cmake --build build --target clean, or remove the build folder",
    "run": "a program of this computer runs by its name in the build folder; 'epg simulate' runs a scenario",
    **dict.fromkeys(("upload", "program"), "'epg flash' writes the images of a system; docs/bring-up.md has one board"),
    **dict.fromkeys(("init", "create", "start"), "'epg new' writes a project"),
    **dict.fromkeys(("list", "boards", "kinds"), "'epg targets' lists targets and kinds"),
    **dict.fromkeys(("validate", "verify", "lint"), "'epg check' checks files"),
    **dict.fromkeys(("monitor", "console", "watch"), "'epg live' shows the values of a running target"),
    **dict.fromkeys(("gui", "ui", "edit", "wire"), "'epg connect' connects ports, in the browser or the terminal"),
    **dict.fromkeys(
        ("update", "upgrade"), "'epg bind --update' adds new ports of a model, 'epg migrate' compares versions"
    ),
    "install": "'epg doctor' lists missing tools, with the commands that install them",
    "help": "'epg --help' lists the commands",
    "version": "'epg --version' prints the version",
}
"""Words that users write in place of a command, and what does that."""

WITHOUT_PACKAGES = ("doctor", "find-tools")
"""The commands that must run while Python packages are missing.  They install none."""

SHORT = ("check", "generate", "generate-model", "generate-system", "generate-all", "model-variables", "link-model")
"""The commands that end after a moment.  They run without Python's garbage collector, because almost all of their
objects live as long as they run."""

LISTING = ("connect", "find-tools", "new", "schema", "targets")
"""The commands that list all that exists, or that go on after an unknown word: they begin with the plug-ins."""

UNKNOWN = (
    "board-not-found",
    "targets-not-found",
    "tcf-not-found",
    "unknown-kind",
    "unknown-middleware",
    "unknown-target",
)
"""Messages about words that a plug-in's folder of targets can explain."""

EXIT_OK, EXIT_MISTAKES, EXIT_USAGE, EXIT_BUG, EXIT_MISSING = range(5)


class MissingProgram(Exception):
    """Something is missing on the computer.  The message says how to install it."""


def main(arguments: Sequence[str] | None = None) -> int:
    """Runs ``epg`` with ``arguments``, or with those of the process.  Returns the exit status."""
    words = sys.argv[1:] if arguments is None else arguments
    command = _command(words)
    if arguments is None and command in SHORT:
        gc.disable()
    try:
        if command not in WITHOUT_PACKAGES:
            bootstrap.ensure()
        parser = _parser(words)
        options = _options(words, parser)
    except bootstrap.MissingPackages as problem:
        sys.stderr.write(f"{problem}\n")
        return EXIT_MISSING
    except SystemExit as stop:
        return int(stop.code or 0)
    if options.cmake_dir or options.examples_dir or options.twenty_sim_dir:
        _print_folder(options)
        return EXIT_OK
    if not options.command:
        parser.print_help()
        return EXIT_USAGE
    return _run(options)


def _options(words: Sequence[str], parser: argparse.ArgumentParser) -> argparse.Namespace:
    """The options of the command line.  Exits if it is wrong, or asks for help."""
    command = _command(words)
    if command is not None and command == words[0] and command not in _commands(words):
        _refuse_command(command, parser)
    options, unknown = parser.parse_known_args(words)
    if unknown:
        _refuse(unknown, getattr(options, "parser", parser))
    return options


def _print_folder(options: argparse.Namespace) -> None:
    from epg.generator.data import data_folder

    if options.twenty_sim_dir:
        print(data_folder("integration") / "20-sim" / "EPG")
    else:
        print(data_folder("cmake" if options.cmake_dir else "examples").as_posix())


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
    commands = _commands(arguments)
    shown = {chosen: commands[chosen]} if chosen in commands and chosen == arguments[0] else commands
    for name, summary in shown.items():
        sub = subparsers.add_parser(name, help=summary, description=summary[0].upper() + summary[1:] + ".")
        if name == chosen:
            sub.set_defaults(parser=sub)
            sub.add_argument("--json", action="store_true", help="print JSON, for programs")
            _module(name).add_arguments(sub)
    return parser


@cache
def _of_plugins() -> dict[str, Any]:
    """The commands of plug-ins: modules, or objects, with ``SUMMARY``, ``add_arguments`` and ``run``."""
    from epg.generator.diagnostics import UserError
    from epg.generator.plugins import entry_points, load

    def fits(found: object) -> bool:
        return all(hasattr(found, name) for name in ("SUMMARY", "add_arguments", "run")) and not isinstance(found, type)

    wanted, entries = "a module with SUMMARY, add_arguments and run", sorted(entry_points("commands").items())
    try:
        return {name: load(entry, wanted, fits) for name, entry in entries if name not in COMMANDS}
    except UserError as problem:
        from epg.cli.report import format_diagnostics

        sys.stderr.write(format_diagnostics(problem.diagnostics))
        sys.exit(EXIT_MISSING)


def _commands(words: Sequence[str]) -> dict[str, str]:
    """The commands with their summaries; those of plug-ins, too, for a word that is not known, and for the help."""
    command = _command(words)
    if command in COMMANDS or (command is None and words and not {"-h", "--help"} & {*words}):
        return COMMANDS
    return COMMANDS | {name: module.SUMMARY for name, module in _of_plugins().items()}


def _module(command: str) -> Any:
    """The module of a command."""
    if command in COMMANDS:
        return importlib.import_module(f"epg.cli.{command.replace('-', '_')}")
    return _of_plugins()[command]


_NEAR = 0.7
"""The similarity, from 0 to 1, of an option and the one that is meant: ``--message`` is not ``--namespace``."""


def _refuse_command(command: str, parser: argparse.ArgumentParser) -> None:
    """Exits, because there is no such command, and says what the user can do instead."""
    from epg.generator.diagnostics import did_you_mean

    instead = INSTEAD.get(command.casefold()) or did_you_mean(command, COMMANDS)
    parser.error(f"there is no command '{command}' ({instead})")


def _refuse(unknown: Sequence[str], parser: argparse.ArgumentParser) -> None:
    """Exits with the usage of the command, because it does not have the ``unknown`` options."""
    from epg.generator.diagnostics import nearest

    known = {option.lstrip("-"): option for option in parser._option_string_actions}
    written = [argument.partition("=")[0].lstrip("-") for argument in unknown if argument.startswith("--")]
    likely = [known[name] for option in written for name in nearest(option, known, _NEAR)]
    meant = " and ".join(f"'{option}'" for option in dict.fromkeys(likely))
    near = f" (did you mean {meant}?)" if meant else ""
    parser.error(f"unrecognized arguments: {' '.join(unknown)}{near}")


def _run(options: argparse.Namespace) -> int:
    """Runs the chosen subcommand, prints its diagnostics and returns the exit status."""
    from epg.generator.diagnostics import Diagnostics

    diagnostics = Diagnostics()
    try:
        status = _run_command(options, diagnostics)
        if any(item.id in UNKNOWN for item in diagnostics) and _add_targets_of_plugins(diagnostics):
            diagnostics = Diagnostics()
            status = _run_command(options, diagnostics)
    except (MissingProgram, bootstrap.MissingPackages) as problem:
        sys.stderr.write(f"epg: {problem}\n")
        return EXIT_MISSING
    except BrokenPipeError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return EXIT_OK
    except KeyboardInterrupt:
        return 130
    except Exception as problem:
        return _failed(problem, diagnostics)
    _report(options, status, diagnostics)
    return EXIT_MISTAKES if diagnostics.has_errors else status


def _run_command(options: argparse.Namespace, diagnostics: Diagnostics) -> int:
    """Runs the chosen subcommand.  Returns its status; the mistakes of users are in ``diagnostics``."""
    from epg.generator.diagnostics import UserError

    if options.command in LISTING:
        _add_targets_of_plugins(diagnostics)
    try:
        return _module(options.command).run(options, diagnostics) or EXIT_OK
    except UserError as problem:
        if problem.diagnostics is not diagnostics:
            diagnostics.items.extend(problem.diagnostics)
    return EXIT_OK


def _add_targets_of_plugins(diagnostics: Diagnostics) -> bool:
    """Adds the folders of targets of plug-ins to those of the user.  Returns False if there are no new ones."""
    from epg.generator.diagnostics import UserError
    from epg.generator.plugins import targets_folders

    known = [folder for folder in os.environ.get("EPG_TARGETS_PATH", "").split(os.pathsep) if folder]
    try:
        new = [str(folder) for folder in targets_folders() if str(folder) not in known]
    except UserError as problem:
        diagnostics.items.extend(problem.diagnostics)
        return False
    os.environ["EPG_TARGETS_PATH"] = os.pathsep.join([*known, *new])
    return bool(new)


def _failed(problem: Exception, diagnostics: Diagnostics) -> int:
    """Says why a command could not end.  Returns the exit status."""
    blamed = bootstrap.blame(problem)  # a library of a package
    if blamed:
        sys.stderr.write(f"epg: {blamed}")
        return EXIT_MISSING
    if isinstance(problem, OSError):  # a folder that cannot be written, a full disk
        from epg.generator.install import long_path_remedy

        where = f"{problem.filename}: " if problem.filename else ""
        hint = long_path_remedy(str(problem.filename or ""))
        sys.stderr.write(f"epg: {where}{problem.strerror or problem}\n")
        sys.stderr.write(f"hint: {hint}\n" if hint else "")
        return EXIT_MISSING
    import traceback

    from epg.cli.report import format_diagnostics

    sys.stderr.write(format_diagnostics(diagnostics))
    traceback.print_exception(problem)
    sys.stderr.write(f"epg: this is a bug in EPG {epg.__version__}; please report it with the lines above\n")
    return EXIT_BUG


def _report(options: argparse.Namespace, status: int, diagnostics: Diagnostics) -> None:
    """Prints the diagnostics in the form that the options ask for."""
    from epg.cli.report import diagnostics_data, format_diagnostics, to_json

    if getattr(options, "format", None) == "sarif" and status != EXIT_USAGE:
        from pathlib import Path

        from epg.cli.sarif import to_sarif

        sys.stdout.write(to_sarif(diagnostics, Path.cwd()))
    elif diagnostics.items and options.json and diagnostics.has_errors:
        sys.stdout.write(to_json({"diagnostics": diagnostics_data(diagnostics)}))
    sys.stderr.write(format_diagnostics(diagnostics))
