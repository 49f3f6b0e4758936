# SPDX-License-Identifier: Apache-2.0
"""``epg connect``: connects a model's ports with a target's components, in the browser or in the terminal."""

from __future__ import annotations

import argparse
import os
import signal
import sys
import threading
from pathlib import Path
from typing import TYPE_CHECKING

from epg.cli.arguments import add_target_arguments, request_of, user_roots
from epg.cli.report import format_diagnostics, to_json
from epg.cli.system import is_system
from epg.generator.diagnostics import Diagnostics
from epg.generator.system import here

if TYPE_CHECKING:
    from epg.connect.projects import Job
    from epg.connect.session import Session

_TEXT_BROWSERS = frozenset(("lynx", "w3m", "links", "elinks", "links2", "www-browser"))


def add_arguments(parser: argparse.ArgumentParser) -> None:
    folder = "folder of a project (a CMakeLists.txt with epg_add_target), of a system or of a model, or the file of a "
    folder += "system (*.system.yaml); default: the current folder"
    parser.add_argument("folder", nargs="?", type=Path, metavar="FOLDER", help=folder)
    add_target_arguments(parser, required=False)
    parser.add_argument("--name", help="name of the target; if FOLDER has several, the one to show first")
    parser.add_argument("--source-dir", type=Path, metavar="FOLDER", help="folder of the project, to build it")
    parser.add_argument("--build-dir", type=Path, metavar="FOLDER", help="build folder of the project")
    parser.add_argument(
        "--built-by", choices=("cmake", "west"), default="cmake", help="the program that builds the project"
    )
    parser.add_argument("--port", type=int, default=0, help="port of the page's address; default: any free port")
    parser.add_argument("--no-browser", action="store_true", help="only print the address")
    parser.add_argument("--until-closed", action="store_true", help="end when the page is closed")
    parser.add_argument("--live", action="store_true", help="open the page at the tab Live, for a target that runs")
    parser.add_argument(
        "--run",
        type=Path,
        metavar="PROGRAM",
        help="with --live: run the target's program in real time, and connect to it",
    )
    parser.add_argument("--terminal", action="store_true", help="ask in this terminal, without a browser")


def run(options: argparse.Namespace, diagnostics: Diagnostics) -> int:
    problem = _problem(options)
    if problem:
        sys.stderr.write(f"epg connect: {problem}\n")
        return 2
    session = _session(options, diagnostics)
    if options.terminal:
        from epg.connect.terminal.dialog import run as run_terminal

        return run_terminal(session, sys.stdin, sys.stdout)
    if not options.live:
        return _serve(session, options)
    try:
        _go_live(session, options.run, diagnostics)
        diagnostics.stop_if_errors()
        return _serve(session, options)
    finally:
        session.runs.close()


def _problem(options: argparse.Namespace) -> str:
    """The reason why the options are not possible together; empty if they are."""
    given = [options.tcf, options.model, options.bindings]
    if any(given) and (not all(given) or options.folder is not None):
        return "name a FOLDER, or give --tcf, --model and --bindings"
    if not 0 <= options.port <= 65535:
        return "--port must be from 0 to 65535"
    if (options.terminal and options.live) or (options.run is not None and not options.live):
        return "--run needs --live, and --live needs the page, not --terminal"
    return ""


def _session(options: argparse.Namespace, diagnostics: Diagnostics) -> Session:
    """The session with the target of the options, or with the project, the system or the model in their folder."""
    from epg.connect.session import Session

    if options.tcf:
        return Session([_job(options)], user_roots=user_roots())
    folder = Path(os.path.abspath(options.folder or "."))
    system = folder if is_system(folder) else None
    jobs = _jobs(folder, options.name, diagnostics) if system is None else []
    diagnostics.stop_if_errors()
    if system is None and not jobs:
        system = _system_in(folder, diagnostics)
        diagnostics.stop_if_errors()
    if system is not None:
        project = folder if folder.is_dir() else system.parent
        jobs = _system_jobs(system, project, options.name, diagnostics)
        diagnostics.stop_if_errors()
        return Session(jobs, folder=project, system=system, user_roots=user_roots())
    if jobs:
        return Session(jobs, folder=jobs[0].source_dir, user_roots=user_roots())
    _check_model(folder, diagnostics)
    diagnostics.stop_if_errors()
    return Session([], model=folder, user_roots=user_roots())


def _go_live(session: Session, program: Path | None, diagnostics: Diagnostics) -> None:
    """Lets the page begin with the tab Live.  Runs ``program``, and connects with it.  Mistakes are reported."""
    from epg.connect.session import Refused
    from epg.generator.source import Span

    span = session.without_console
    if span is not None:
        hint = "add 'console: true' to 'communication'; without a console, ROS 2 has its topics and parameters"
        diagnostics.error("no-console", span, "this target has no console, so the page cannot watch it", hint=hint)
        return
    session.opens_live = True
    if program is None:
        return
    span = Span(str(program))
    if not program.is_file():
        hint = "build it first; it is in the build folder, with the name in epg_add_executable()"
        diagnostics.error("file-not-found", span, f"there is no program '{program}'", hint=hint)
        return
    try:
        session.run_live(Path(os.path.abspath(program)))
    except Refused as problem:
        hint = (
            problem.hint
            or "the program must be one of epg_add_executable() for the host; start it in a terminal to see more"
        )
        diagnostics.error("program-not-started", span, problem.message.replace("\n", ": "), hint=hint)


def _serve(session: Session, options: argparse.Namespace) -> int:
    """Serves the page until it ends, and prints an address for each page that can be opened."""
    from epg.connect.server import Server

    shown = 0

    def announce(address: str) -> None:
        nonlocal shown
        shown += 1
        if options.json:
            sys.stdout.write(to_json({"address": address}))
        elif shown == 1:
            print(f"epg connect: {address}")
            print("Press Ctrl-C here, or 'Close EPG' in the page, to end.")
        else:
            print(f"epg connect: for another page: {address}")
        sys.stdout.flush()

    server = Server(session, options.port, announce=announce)
    if not options.no_browser:
        # A second address: other users can see the arguments of the browser, and must not learn the printed address.
        address = server.new_address()
        # In a thread: some browsers return only when they are closed.
        threading.Thread(target=_open_browser, args=(address,), daemon=True).start()
    for number in here.end_signals():  # end as after Ctrl-C, so that a running build is also ended
        signal.signal(number, signal.default_int_handler)
    try:
        server.run(until_closed=options.until_closed)
    except KeyboardInterrupt:
        print()
    if session.has_changes:
        sys.stderr.write("epg connect: changes that were not saved are lost\n")
    return 0


def _job(options: argparse.Namespace) -> Job:
    """The target that the options name.  Its paths are absolute, because a build can run in another folder."""
    from dataclasses import replace

    from epg.connect.projects import Job, find_jobs

    request = request_of(options, options.name or Path(options.bindings).name.split(".")[0])
    beside = Path(os.path.abspath(request.beside))
    absolute = replace(
        request,
        model=Path(os.path.abspath(request.model)),
        bindings=Path(os.path.abspath(request.bindings)),
        plant=_absolute(request.plant),
        plant_bindings=_absolute(request.plant_bindings),
        ioc=_absolute(request.ioc),
        beside=beside,
    )
    source, build = _absolute(options.source_dir), _absolute(options.build_dir)
    found = find_jobs(source, Diagnostics()) if source is not None else []
    # The project's own record of the target also names its executables.
    known = next((job for job in found if job.request.name == request.name), Job(absolute))
    build = build or known.build_dir
    return replace(known, request=absolute, source_dir=source, build_dir=build, built_by=options.built_by)


def _system_in(folder: Path, diagnostics: Diagnostics) -> Path | None:
    """The system in ``folder``, None if there is none.  Several are reported."""
    from epg.connect.projects import find_systems
    from epg.generator.source import Span

    systems = find_systems(folder)
    if len(systems) > 1:
        names = ", ".join(os.path.relpath(path, folder) for path in systems)
        message = "there are several systems here"
        diagnostics.error("several-systems", Span(str(folder)), message, hint=f"name one of them: {names}")
    return systems[0] if systems else None


def _system_jobs(path: Path, folder: Path, name: str | None, diagnostics: Diagnostics) -> list[Job]:
    """The target ``name`` of the system in ``path``; none without a name: the page then shows the whole system.

    Mistakes are reported if nothing could be shown.
    """
    from epg.cli.system import target_of
    from epg.connect.projects import system_jobs
    from epg.generator.source import Span
    from epg.system.load_system import parse_system

    found = Diagnostics()
    system = parse_system(path, found)
    if system is None:
        diagnostics.items.extend(found)
    if system is None or name is None:
        return []
    target_of(system, name, Span(str(path)), diagnostics)
    return [job for job in system_jobs(path, folder, user_roots()) if job.request.name == name]


def _absolute(path: Path | None) -> Path | None:
    return None if path is None else Path(os.path.abspath(path))


def _jobs(folder: Path, name: str | None, diagnostics: Diagnostics) -> list[Job]:
    """The targets of the project in ``folder``, or of the project around the model in it.

    The target ``name`` comes first.  If there is no such target, this is reported.
    """
    from epg.connect.projects import find_jobs, jobs_of_model
    from epg.generator.diagnostics import did_you_mean
    from epg.generator.source import Span

    problems = Diagnostics()
    jobs = find_jobs(folder, problems)
    if problems.has_errors:
        diagnostics.items.extend(problems)
    else:  # print warnings before the page opens: the session can last for hours
        sys.stderr.write(format_diagnostics(problems))
    if not jobs and not diagnostics.has_errors:
        jobs = jobs_of_model(folder)
    if name is not None and jobs:
        names = [job.request.name for job in jobs]
        if name not in names:
            hint = did_you_mean(name, names, "targets")
            diagnostics.error("unknown-target", Span(str(folder)), f"there is no target '{name}'", hint=hint)
            return []
        jobs.sort(key=lambda job: job.request.name != name)
    return jobs


def _check_model(folder: Path, diagnostics: Diagnostics) -> None:
    """Reports the problems of a folder that holds neither a target nor a model that can be used."""
    from epg.connect.projects import report_no_target
    from epg.generator.importers import load_model

    problems = Diagnostics()
    load_model(folder, problems)
    if any(problem.id == "model-not-recognised" for problem in problems):
        report_no_target(folder, diagnostics)
    if not diagnostics.has_errors:
        diagnostics.items.extend(problems)


def _open_browser(address: str) -> None:
    """Opens the page in a graphical browser, if there is one.  A browser in the terminal would hide the address."""
    import webbrowser

    try:
        browser = webbrowser.get() if here.has_screen() else None
    except webbrowser.Error:
        browser = None
    if browser is None or Path(getattr(browser, "name", "")).name in _TEXT_BROWSERS or not browser.open(address):
        sys.stderr.write("epg connect: no browser was opened: open the address above yourself\n")
