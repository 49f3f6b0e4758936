# SPDX-License-Identifier: Apache-2.0
"""The tools that a build for a platform needs, and the remedy if one is missing, as ``epg doctor`` reports them.

>>> # list(missing_tools(find_tools(platform.needs, roots), roots))  ->  ["picotool"]
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from pathlib import Path

from epg.connect.build.build_messages import BuildMessage
from epg.connect.projects import Job, find_jobs
from epg.generator.bootstrap import cache_folder
from epg.generator.catalog.catalog import load_catalog
from epg.generator.check.communication import tools_for
from epg.generator.check.configuration import Configuration
from epg.generator.dataclass import dataclass
from epg.generator.diagnostics import Diagnostics
from epg.generator.project import load_configuration
from epg.generator.tools.find_tool import Finding, Surroundings, find_tool
from epg.generator.tools.remedy import command_for, problem_of
from epg.generator.tools.tools import Tool, load_tools

ALWAYS = ("cmake", "build_program")
"""The tools that every build needs."""
_GENERATED = "CMakeFiles/TargetDirectories.txt"
"""A file that CMake writes when a build folder is configured completely."""


@dataclass(frozen=True)
class Lack:
    """The tools that a build of a target needs and that this computer does not have.

    ``certain`` are the messages about tools without which nothing can be started.  ``likely`` are those about tools
    that the project's own CMake files may still find.  ``downloads`` are libraries that the build downloads.
    """

    certain: tuple[BuildMessage, ...] = ()
    likely: tuple[BuildMessage, ...] = ()
    downloads: tuple[Tool, ...] = ()


def lack_of(
    job: Job,
    configuration: Configuration | None,
    findings: Sequence[Finding],
    build: Path,
    cache: Mapping[str, str],
    *,
    run: bool,
) -> Lack:
    """The tools that are missing for a build of ``job`` in the folder ``build``.

    ``findings`` are the tools that start the build.  If the folder was configured before, CMake has found the tools of
    the target; only those of its middlewares are searched then, because the middleware may have changed.
    """
    roots = job.request.roots
    certain = tuple(missing_tools(findings, roots, cache).values())
    if configuration is None:
        return Lack(certain)
    names = tools_for(configuration.target, configuration.communication)
    if (build / _GENERATED).is_file():
        names = {name for used in configuration.communication.middlewares for name in used.needs}
    source = job.source_dir or job.request.beside
    known = {finding.tool.name for finding in findings}
    others = find_tools(sorted(names - known), roots, cache, run=run)
    others = [each for each in others if not any((source / file).is_file() for file in each.tool.in_project)]
    (git,) = find_tools(["git"], roots, cache, run=run)
    downloads = tuple(_downloads(others, git, cache))
    absent = [each for each in others if each.status != "found" and each.tool not in downloads]
    if any("git clone" in each.tool.get.get("any", "") for each in absent):
        absent = [git, *absent]  # the commands below need it
    return Lack(certain, tuple(missing_tools(absent, roots, cache).values()), downloads)


def _downloads(findings: Iterable[Finding], git: Finding, cache: Mapping[str, str]) -> Iterator[Tool]:
    """The missing libraries among ``findings`` that the build downloads with ``git``, if it may do so."""
    offline = cache.get("FETCHCONTENT_FULLY_DISCONNECTED", "").upper() in ("ON", "TRUE", "YES", "Y", "1")
    if git.path and not offline:
        yield from (each.tool for each in findings if each.status == "missing" and each.tool.fetched)


def download_problem(tool: Tool, said: str, roots: Sequence[Path], cache: Mapping[str, str]) -> BuildMessage:
    """The message about a library that is missing and cannot be downloaded.  Git has ``said`` the reason."""
    command = command_for(tool, Surroundings.here(cache_folder(), cache), load_tools(roots, Diagnostics()))
    message = f"{tool.title} was not found, and cannot be downloaded from {tool.fetched}: {said}"
    return BuildMessage("error", message, hint=f"get it: {command}", id="tool-missing")


def find_tools(
    names: Sequence[str], roots: Sequence[Path], cmake: Mapping[str, str] | None = None, *, run: bool = True
) -> list[Finding]:
    """Searches the tools called ``names``.  Names that are not known are left out.

    ``cmake`` are the variables of a build folder's CMake cache.  The programs that they name are started only with
    ``run``.
    """
    tools = load_tools(roots, Diagnostics())
    where = Surroundings.here(cache_folder(), cmake, run=run)
    return [find_tool(tools[name], where) for name in names if name in tools]


def missing_tools(
    findings: Iterable[Finding], roots: Sequence[Path], cmake: Mapping[str, str] | None = None
) -> dict[str, BuildMessage]:
    """A message for each tool in ``findings`` that a build cannot use, by its title."""
    tools = load_tools(roots, Diagnostics())
    where = Surroundings.here(cache_folder(), cmake)
    problems = {}
    for finding in findings:
        if finding.status == "found":
            continue
        hint = f"correct or unset the {finding.source}"
        if finding.status != "wrong":
            hint = f"get it: {command_for(finding.tool, where, tools)}"
        problems[finding.tool.title] = BuildMessage("error", problem_of(finding), hint=hint, id="tool-missing")
    return problems


def tools_of_project(folder: Path) -> list[str]:
    """The names of the tools that the targets of the project in ``folder`` need.

    Targets whose configuration cannot be read are left out.
    """
    names: set[str] = set()
    for job in find_jobs(folder, Diagnostics()):
        catalog = load_catalog(job.request.roots, Diagnostics())
        configuration = load_configuration(job.request, catalog, Diagnostics())
        if configuration is not None:
            names |= tools_for(configuration.target, configuration.communication)
    return sorted(names)
