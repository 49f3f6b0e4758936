# SPDX-License-Identifier: Apache-2.0
"""Plans a build: the same commands that a user would type, and their environment.

>>> # plan = make_plan(job, target)
>>> # [step.command for step in plan.steps]  ->  [("cmake", "-S", ..., "-B", "build"), ("cmake", "--build", "build")]
"""

from __future__ import annotations

import json
import os
import shutil
import sys
from collections.abc import Mapping
from pathlib import Path

from epg.connect.build.build_messages import BuildMessage
from epg.connect.build.build_tools import ALWAYS, find_tools, lack_of
from epg.connect.build_folders import CACHE, USUAL
from epg.connect.projects import Job
from epg.generator.check.configuration import Configuration
from epg.generator.data import data_folder
from epg.generator.dataclass import dataclass
from epg.generator.diagnostics import Diagnostics
from epg.generator.tools.find_tool import read_cmake_cache
from epg.generator.tools.tools import Tool

NINJA = "Ninja"


@dataclass(frozen=True)
class Command:
    """One command.  ``name`` is "configure" or "build"."""

    name: str
    command: tuple[str, ...]
    folder: Path


@dataclass(frozen=True)
class Plan:
    """The commands of a build.  If tools are ``missing``, there are no steps.

    ``can_try`` is True if the project's own CMake files may find these tools.  ``downloads`` are libraries that the
    build downloads.
    ``cache`` are the variables in the build folder's CMake cache.  ``build_program`` is Ninja or Make, as that cache
    names it, or the program that was found.
    """

    source: Path
    build: Path
    steps: tuple[Command, ...]
    environment: Mapping[str, str]
    cache: Mapping[str, str]
    missing: tuple[BuildMessage, ...] = ()
    can_try: bool = False
    downloads: tuple[Tool, ...] = ()
    build_program: str = ""


def make_plan(job: Job, configuration: Configuration | None, *, run: bool = True, anyway: bool = False) -> Plan:
    """The plan for ``job``.  It builds all targets of the project, as the user's own ``cmake --build`` would do.

    The products are therefore the same, including files that are made after linking, such as ``.uf2``.

    ``configuration`` is None if it has an error; CMake then reports it.  The simulation of a
    system does not use it: this build needs no tools of the target.  Without ``run``, no program that the build
    folder names is started, not even to ask for its version.  With ``anyway``, there are steps even if tools are
    missing that the project's own CMake files may find.
    """
    source = Path(os.path.abspath(job.source_dir or job.request.beside))
    build = Path(os.path.abspath(job.build_dir or source / USUAL))
    if job.simulated:
        configuration = None
    cache = read_cmake_cache(build / CACHE, Diagnostics())
    outdated = configuration is not None and _is_of_another_target(job, configuration, source, build, cache)
    cache = {} if outdated else cache
    west = job.built_by == "west"
    names = (*ALWAYS, *(["west", "zephyr"] if west and not cache else []))
    findings = find_tools(names, job.request.roots, cache, run=run)
    lack = lack_of(job, configuration, findings, build, cache, run=run)
    if lack.certain or (lack.likely and not anyway):
        return Plan(source, build, (), {}, cache, (*lack.certain, *lack.likely), can_try=not lack.certain)
    programs = {finding.tool.name: str(finding.path) for finding in findings}
    folders = _Folders(source, build, cache, programs)
    configure = folders.again(west) if cache else folders.first(job, configuration)
    steps = (*([folders.emptied()] if outdated else []), configure, folders.built())
    environment = _environment(os.environ, cache, west=west)
    build_program = cache.get("CMAKE_MAKE_PROGRAM") or programs["build_program"]
    return Plan(source, build, steps, environment, cache, downloads=lack.downloads, build_program=build_program)


def _is_of_another_target(
    job: Job, configuration: Configuration, source: Path, build: Path, cache: Mapping[str, str]
) -> bool:
    """True if the build folder was configured for another board or platform: its compiler and board cannot be used."""
    if not cache or os.path.realpath(cache.get("CMAKE_HOME_DIRECTORY", "")) != os.path.realpath(source):
        return False
    name = job.request.name
    try:
        text = (build / "epg" / name / f"{name}.json").read_text(encoding="utf-8")
        return bool(json.loads(text)["target"]["name"] != configuration.target.name)
    except (OSError, ValueError, KeyError, TypeError):
        return False  # nothing was generated yet


@dataclass(frozen=True)
class _Folders:
    """The commands for the folders of a project.  ``programs`` are the paths of the tools that start the build."""

    source: Path
    build: Path
    cache: Mapping[str, str]
    programs: Mapping[str, str]

    def emptied(self) -> Command:
        """Removes the configuration of the build folder, as ``cmake --fresh`` does."""
        files = (str(self.build / CACHE), str(self.build / "CMakeFiles"))
        return Command("configure", (self.programs["cmake"], "-E", "rm", "-rf", *files), self.source)

    def again(self, west: bool) -> Command:
        """Configures a build folder that was configured before."""
        home = self.cache.get("CMAKE_HOME_DIRECTORY", "") if west else ""  # with sysbuild: not the application's folder
        command = (self.programs["cmake"], "-S", home or str(self.source), "-B", str(self.build))
        return Command("configure", command, self.source)

    def first(self, job: Job, configuration: Configuration | None) -> Command:
        """Configures for the first time."""
        if job.built_by != "west":
            return self._by_cmake(job.preset)
        target = configuration.target if configuration is not None else None
        return self._by_west(job.board or (target.board.sdks.get(target.platform.sdk, "") if target else ""))

    def _by_cmake(self, preset: str) -> Command:
        """Configures with the preset for this folder, if any, and with Ninja if found."""
        chosen = ("--preset", preset) if preset else ("-S", str(self.source))
        ninja = Path(self.programs["build_program"])
        generator: tuple[str, ...] = ()
        if "ninja" in ninja.name.lower() and not os.environ.get("CMAKE_GENERATOR"):
            generator = ("-G", NINJA)
            if shutil.which(ninja.name) is None:
                generator += (f"-DCMAKE_MAKE_PROGRAM={ninja.as_posix()}",)
        command = (self.programs["cmake"], *chosen, "-B", str(self.build), *generator)
        return Command("configure", command, self.source)

    def _by_west(self, board: str) -> Command:
        """Configures with ``west build``, which finds Zephyr.

        west must run in a workspace.  If the project is not in one, it runs in Zephyr's folder.
        """
        around = [folder for folder in (self.source, *self.source.parents) if (folder / ".west").is_dir()]
        folder = self.source if around else Path(self.programs["zephyr"])
        command = [self.programs["west"], "build", "--cmake-only", "-d", str(self.build)]
        return Command("configure", (*command, *(("-b", board) if board else ()), str(self.source)), folder)

    def built(self) -> Command:
        command = (self.programs["cmake"], "--build", str(self.build), *self._parallel())
        return Command("build", command, self.source)

    def _parallel(self) -> tuple[str, ...]:
        """The option for a parallel build.  Make uses one processor by default, Ninja all of them."""
        is_ninja = "ninja" in Path(self.programs["build_program"]).name
        generator = self.cache.get("CMAKE_GENERATOR", "") or (NINJA if is_ninja else "")
        if generator.startswith(NINJA) or os.environ.get("CMAKE_BUILD_PARALLEL_LEVEL"):
            return ()
        return ("--parallel", str(os.cpu_count() or 1))


_OF_MAKE = ("MAKEFLAGS", "MFLAGS", "MAKELEVEL", "MAKE_TERMOUT", "MAKE_TERMERR")
"""Variables that Make sets for its commands.  ``epg connect`` may be such a command; its builds must not see them."""
_SAY_WHICH_EPG = ("EPG_PATH", "EPG_DIR", "EPG_IMPORTED_DIR")
_COLOURS = ("CLICOLOR_FORCE", "FORCE_COLOR", "CMAKE_COLOR_DIAGNOSTICS")


def _environment(own: Mapping[str, str], cache: Mapping[str, str], *, west: bool) -> dict[str, str]:
    """The environment of the commands: that of this process, without colours, and with messages in English.

    Variables of Make and of EPG's own Python are removed, so the commands run as if the user had typed them.
    If neither the build folder nor the user says which EPG to use, the running one is used, with its virtual
    environment.
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
