# SPDX-License-Identifier: Apache-2.0
"""``epg flash``: writes the images of a system to its boards."""

from __future__ import annotations

import argparse
import shutil
import sys
from pathlib import Path
from typing import TYPE_CHECKING

from epg.cli.arguments import user_roots
from epg.generator import bootstrap
from epg.generator.data import targets_roots
from epg.generator.diagnostics import Diagnostics
from epg.generator.tools.find_tool import Surroundings
from epg.generator.tools.remedy import get_it
from epg.generator.tools.tools import Tool, load_tools

if TYPE_CHECKING:
    from epg.cli.main import MissingProgram
    from epg.system.flash import FlashJob


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("system", type=Path, metavar="SYSTEM", help="the system (*.system.yaml)")
    parser.add_argument(
        "--images",
        type=Path,
        metavar="FOLDER",
        help="folder of the images; default: build/<system>_images beside the file of the system",
    )
    parser.add_argument(
        "--target", action="append", metavar="TARGET", help="flash this target only; repeat the option for others"
    )
    parser.add_argument("--dry-run", action="store_true", help="print the commands, and run none")
    parser.add_argument("--replace", action="store_true", help="overwrite programs of other targets, too")


def run(options: argparse.Namespace, diagnostics: Diagnostics) -> int:
    from epg.cli.report import to_json
    from epg.cli.system import target_of
    from epg.generator.source import Span
    from epg.system.check_system import check_system
    from epg.system.flash import Flasher, UnusableTool, flashing_of, plan
    from epg.system.images import images_of
    from epg.system.load_system import load_system

    system = diagnostics.checked(load_system(options.system, diagnostics, Span("command line")))
    for name in options.target or ():
        target_of(system, name, Span.of_argument(name, "--target"), diagnostics)
    checked = diagnostics.checked(check_system(system, user_roots(), diagnostics))
    built = [name for name, _, _ in images_of(checked) if flashing_of(checked, name) is not None]
    if not built and not options.target:
        message = "none of its targets has an image that EPG builds"
        hint = "docs/systems.md lists the platforms with images"
        diagnostics.error("not-flashable", Span(str(system.path)), message, hint=hint)
    images = options.images or system.path.parent / "build" / f"{system.name}_images"
    jobs = plan(checked, options.target or built, images, diagnostics)
    diagnostics.stop_if_errors()
    programs = _programs(jobs, dry_run=options.dry_run)
    lines: list[str] = []

    def show(line: str) -> None:
        lines.append(line)
        if not options.json:
            print(line, flush=True)

    flasher = Flasher(jobs, programs, diagnostics, show, options.replace)
    if options.dry_run:
        flasher.dry_run()
    else:
        try:
            flasher.run()
        except UnusableTool as problem:
            raise _missing(problem.tool, f"{problem.tool} cannot reach boards: it was built without USB") from None
    if options.json:
        boards = [{"target": job.name, "board": job.shown, "image": job.image.as_posix()} for job in jobs]
        sys.stdout.write(to_json({"boards": boards, "commands": lines}))
    elif not options.dry_run:
        print(f"flashed {', '.join(job.name for job in jobs)}")
    return 0


def _programs(jobs: list[FlashJob], *, dry_run: bool) -> dict[str, str]:
    """The programs of the tools that the jobs need.  A dry run does not need them on this computer."""
    from epg.system.flash import program_of

    programs = {}
    for name in {job.flashing.tool: None for job in jobs}:
        tool = _tools().get(name)
        found = shutil.which(name) if tool is None else program_of(tool, _where())
        if not found and not dry_run:
            raise _missing(name, f"the program {name} was not found")
        programs[name] = found or name
    return programs


def _missing(name: str, problem: str) -> MissingProgram:
    from epg.cli.main import MissingProgram

    tools = _tools()
    return MissingProgram(f"{problem}. {get_it(tools[name], _where(), tools)}" if name in tools else problem)


def _tools() -> dict[str, Tool]:
    return load_tools(targets_roots(user_roots()), Diagnostics())


def _where() -> Surroundings:
    return Surroundings.here(bootstrap.cache_folder())
