# SPDX-License-Identifier: Apache-2.0
"""The tools that a build for a platform needs, and the remedy if one is missing, as ``epg doctor`` reports them.

>>> # list(missing_tools(find_tools(platform.needs, roots), roots))  ->  ["picotool"]
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path

from epg.bootstrap import cache_folder
from epg.catalog.catalog import load_catalog
from epg.check.communication import tools_for
from epg.connect.build.messages import Message
from epg.connect.projects import find_jobs
from epg.diagnostics import Diagnostics
from epg.project import load_configuration
from epg.tools.find_tool import Finding, Surroundings, find_tool
from epg.tools.remedy import command_for, problem_of
from epg.tools.tools import load_tools

ALWAYS = ("cmake", "build_program")
"""The tools that every build needs."""


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
) -> dict[str, Message]:
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
        problems[finding.tool.title] = Message("error", problem_of(finding), hint=hint, id="tool-missing")
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
