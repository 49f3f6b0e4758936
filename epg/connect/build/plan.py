# SPDX-License-Identifier: Apache-2.0
"""What is run to build a project: the commands a person would type, and the environment they run in.

>>> # plan = make_plan(job, target, roots)
>>> # [step.command for step in plan.steps]  ->  [("cmake", "-S", ..., "-B", "build"), ("cmake", "--build", "build")]
"""

from __future__ import annotations

import os
import shutil
import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from epg.catalog.hardware import Target
from epg.connect.build.tools import ALWAYS, MissingTool, find_tools, missing
from epg.connect.build_folders import CACHE, USUAL
from epg.connect.projects import Job
from epg.data import data_folder
from epg.diagnostics import Diagnostics
from epg.tools.find_tool import read_cmake_cache

NINJA = "Ninja"


@dataclass(frozen=True)
class Step:
    """One command.  ``name`` is "configure" or "build"."""

    name: str
    command: tuple[str, ...]
    folder: Path


@dataclass(frozen=True)
class Plan:
    """``missing`` are tools without which nothing can be started; there are no steps then.

    ``build_program`` is Ninja or Make, as the build folder's cache has it.
    """

    source: Path
    build: Path
    steps: tuple[Step, ...]
    environment: Mapping[str, str]
    cache: Mapping[str, str]
    missing: tuple[MissingTool, ...] = ()
    build_program: str = ""


def make_plan(job: Job, target: Target | None, roots: Sequence[Path], *, run: bool = True) -> Plan:
    """How to build ``job``.  All targets of the project are built: what ``cmake --build`` does when a person types it,
    so that what is on the disk afterwards is what they would have, files after the link such as ``.uf2`` included.

    ``target`` is None where its configuration is wrong; CMake then says why.  Without ``run``, programs that the build
    folder names are not even asked for their version.
    """
    source = Path(os.path.abspath(job.source_dir or job.request.beside))
    build = Path(os.path.abspath(job.build_dir or source / USUAL))
    file = build / CACHE
    cache = read_cmake_cache(file, Diagnostics()) if file.is_file() else {}
    west = job.built_by == "west"
    names = (*ALWAYS, *(["west", "zephyr"] if west and not cache else []))
    findings = find_tools(names, roots, cache, run=run)
    lacking = tuple(missing(findings, roots, cache))
    if lacking:
        return Plan(source, build, (), {}, cache, lacking)
    programs = {finding.tool.name: str(finding.path) for finding in findings}
    if cache:
        home = cache.get("CMAKE_HOME_DIRECTORY", "") if west else ""  # of sysbuild: its own, not the application's
        configure = Step("configure", (programs["cmake"], "-S", home or str(source), "-B", str(build)), source)
    elif west:
        configure = _by_west(job, target, source, build, programs)
    else:
        configure = Step("configure", _first(job, source, build, programs), source)
    steps = (configure, Step("build", (programs["cmake"], "--build", str(build), *_parallel(cache, programs)), source))
    environment = _environment(os.environ, cache, west=west)
    build_program = cache.get("CMAKE_MAKE_PROGRAM") or programs["build_program"]
    return Plan(source, build, steps, environment, cache, build_program=build_program)


def _first(job: Job, source: Path, build: Path, programs: Mapping[str, str]) -> tuple[str, ...]:
    """Configures for the first time: by the preset that makes this folder, with Ninja if it is there."""
    preset = ("--preset", job.preset) if job.preset else ("-S", str(source))
    ninja = Path(programs["build_program"])
    generator: tuple[str, ...] = ()
    if "ninja" in ninja.name.lower() and not os.environ.get("CMAKE_GENERATOR"):
        generator = ("-G", NINJA)
        if shutil.which(ninja.name) is None:
            generator += (f"-DCMAKE_MAKE_PROGRAM={ninja.as_posix()}",)
    return (programs["cmake"], *preset, "-B", str(build), *generator)


def _by_west(job: Job, target: Target | None, source: Path, build: Path, programs: Mapping[str, str]) -> Step:
    """``west build`` knows Zephyr; it wants to run in a workspace, which need not be around the project."""
    board = job.board or (target.board.sdks.get(target.platform.sdk, "") if target is not None else "")
    around = [folder for folder in (source, *source.parents) if (folder / ".west").is_dir()]
    folder = source if around else Path(programs["zephyr"])
    command = [programs["west"], "build", "--cmake-only", "-d", str(build)]
    return Step("configure", (*command, *(("-b", board) if board else ()), str(source)), folder)


def _parallel(cache: Mapping[str, str], programs: Mapping[str, str]) -> tuple[str, ...]:
    """Make takes one processor unless it is told otherwise; Ninja takes all."""
    generator = cache.get("CMAKE_GENERATOR", "") or (NINJA if "ninja" in Path(programs["build_program"]).name else "")
    if generator.startswith(NINJA) or os.environ.get("CMAKE_BUILD_PARALLEL_LEVEL"):
        return ()
    return ("--parallel", str(os.cpu_count() or 1))


_OF_MAKE = ("MAKEFLAGS", "MFLAGS", "MAKELEVEL", "MAKE_TERMOUT", "MAKE_TERMERR")
"""What Make hands to what it starts: this may be started by a build, but is none of its parts."""
_SAY_WHICH_EPG = ("EPG_PATH", "EPG_DIR", "EPG_IMPORTED_DIR")
_COLOURS = ("CLICOLOR_FORCE", "FORCE_COLOR", "CMAKE_COLOR_DIAGNOSTICS")


def _environment(own: Mapping[str, str], cache: Mapping[str, str], *, west: bool) -> dict[str, str]:
    """That of this process, as for somebody who types the command: nothing of EPG's own Python, no colours, English.

    A build folder that has not found an EPG yet gets the one that runs now where nothing else is said, and its virtual
    environment, as if that were activated.  Others have their own answers.
    """
    first = not any(cache.get(name) for name in _SAY_WHICH_EPG)
    names = {*_OF_MAKE, *_COLOURS, "PYTHONHOME", "EPG_ABSOLUTE_PATHS"}
    environment = {name: value for name, value in own.items() if name not in names}
    everything = environment.pop("LC_ALL", "")
    if everything:
        environment["LC_CTYPE"] = everything
    environment["LC_MESSAGES"] = "C"
    environment.pop("LANGUAGE", None)
    if first and not own.get("EPG_PATH") and not own.get("EPG_DIR"):
        environment["EPG_DIR"] = data_folder("cmake").as_posix()
    if first and not west and sys.prefix != sys.base_prefix:
        environment.setdefault("VIRTUAL_ENV", sys.prefix)
    return environment
