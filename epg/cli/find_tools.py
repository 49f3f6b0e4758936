# SPDX-License-Identifier: Apache-2.0
"""``epg find-tools``: finds SDKs and tools for CMake, which reads the answer as JSON.

It must run before any Python package is installed.  The answer contains all SDKs, so that one call serves a configure
run.  It contains a program only if it is asked for: EPG must start the program to know its version.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Mapping
from pathlib import Path

from epg.cli.arguments import user_roots
from epg.cli.report import to_json
from epg.generator import bootstrap
from epg.generator.data import targets_roots
from epg.generator.diagnostics import Diagnostics
from epg.generator.tools.find_tool import Finding, Surroundings, find_tool
from epg.generator.tools.project_version import choose_version
from epg.generator.tools.remedy import get_it, problem_of
from epg.generator.tools.tools import Tool, load_tools


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("names", nargs="*", metavar="TOOL[=VERSION]", help="a program, or the version of a tool")
    parser.add_argument(
        "--variable", action="append", default=[], dest="variables", metavar="NAME=VALUE", help="a variable of CMake"
    )


def run(options: argparse.Namespace, diagnostics: Diagnostics) -> int:
    bootstrap.check_cache()
    tools = load_tools(targets_roots(user_roots()), diagnostics)
    diagnostics.stop_if_errors()
    cmake = dict(text.split("=", 1) for text in options.variables)
    where = Surroundings.here(bootstrap.cache_folder().absolute(), cmake)
    names = [name.partition("=")[0] for name in options.names]
    chosen = (name.partition("=") for name in options.names)
    versions = {name: choose_version(tools[name], wanted, where, tools) for name, _, wanted in chosen if wanted}
    answer = {
        "cache": where.cache.as_posix(),
        "versions": [{"variable": c.variable, "folder": c.folder, "problem": c.problem} for c in versions.values()],
        "tools": {
            tool.name: _answer(find_tool(tool, where), where, tools)
            for tool in tools.values()
            if tool.holds or tool.name in names
        },
    }
    sys.stdout.write(to_json(answer))
    return 0


def _answer(finding: Finding, where: Surroundings, tools: Mapping[str, Tool]) -> dict[str, str]:
    """The answer for one tool.  ``variables`` are the variables of CMake that were given for it."""
    tool = finding.tool
    problem, remedy = problem_of(finding), get_it(tool, where, tools)
    return {
        "status": finding.status,
        "folder": _folder(finding).as_posix() if finding.status == "found" and finding.source != "PATH" else "",
        "version": finding.version,
        "problem": f"{problem}. {remedy}" if problem else "",
        "remedy": remedy,
        "variables": ";".join(f"{name}={where.cmake[name]}" for name in tool.variables if name in where.cmake),
    }


def _folder(finding: Finding) -> Path:
    """The folder of an SDK, or the folder of a program or of its ``bin``."""
    assert finding.path is not None
    if finding.tool.holds:
        return finding.path
    folder = finding.path.parent
    return folder.parent if folder.name == "bin" else folder
