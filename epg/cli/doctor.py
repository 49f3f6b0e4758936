# SPDX-License-Identifier: Apache-2.0
"""``epg doctor``: lists the tools and packages that EPG and its targets need, and commands that install missing ones.

Uses only Python's standard library, because it must also run if packages are missing.
"""

from __future__ import annotations

import argparse
import importlib.util
import os
import platform
import sys
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict
from importlib import metadata
from pathlib import Path

import epg
from epg.cli.arguments import user_roots
from epg.cli.report import to_json
from epg.generator import bootstrap
from epg.generator.data import targets_roots
from epg.generator.dataclass import dataclass
from epg.generator.diagnostics import Diagnostics
from epg.generator.install import package_commands
from epg.generator.tools.find_tool import Finding, Surroundings, find_tool, read_cmake_cache
from epg.generator.tools.remedy import command_for
from epg.generator.tools.tools import Tool, load_tools

HOST = "host"


@dataclass(frozen=True)
class ReportedTool:
    """One tool or package in the report.

    ``status`` is "found", "missing", "old" if a newer version is needed, "wrong" if a variable names something else, or
    "later" for a Python package that EPG installs into its cache when it is first needed.  ``remedy`` is the command
    that installs it, or the correction of a wrong variable.
    """

    name: str
    title: str
    needed_for: str
    required: bool
    status: str
    version: str = ""
    path: str = ""
    source: str = ""
    note: str = ""
    remedy: str = ""

    @property
    def good(self) -> bool:
        return self.status in ("found", "later")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--build", type=Path, metavar="FOLDER", help="a build folder: its CMake variables are used, too"
    )
    parser.add_argument(
        "--run", action="store_true", help="start the programs that the build folder names, to read their versions"
    )
    parser.add_argument(
        "--project", type=Path, metavar="FOLDER", help="list only the tools that the targets of this project need"
    )


def run(options: argparse.Namespace, diagnostics: Diagnostics) -> int:
    cmake = read_cmake_cache(options.build / "CMakeCache.txt", diagnostics) if options.build else {}
    tools = load_tools(targets_roots(user_roots()), diagnostics)
    diagnostics.stop_if_errors()
    where = Surroundings.here(bootstrap.cache_folder(), cmake, run=options.run)
    found = {
        name: _item(find_tool(tool, where), where, tools) for name, tool in _wanted(tools, options.project).items()
    }
    if options.project:
        return _report_project(list(found.values()), options.json)
    items = [
        ReportedTool("python", "Python", HOST, True, "found", platform.python_version(), sys.executable),
        *(_package("generator", *package, required=True) for package in bootstrap.requirements("generator").values()),
        *(_package(g, *package, required=False) for g in _USES for package in bootstrap.requirements(g).values()),
        *found.values(),
    ]
    host = all(item.good for item in items if item.needed_for == HOST and item.required)
    if options.json:
        data = {
            "epg": {"version": epg.__version__, "path": _home(), "cache": where.cache.as_posix()},
            "items": [asdict(item) for item in items],
            "host": host,
        }
        sys.stdout.write(to_json(data))
    else:
        print(f"EPG {epg.__version__} in {_home()}, cache in {where.cache.as_posix()}{_cache_note(where.cache)}")
        print("\n".join(_lines(items)))
        print("\nthe host target can be built" if host else "\nthe host target cannot be built")
    return 0 if host else 4


def _wanted(tools: Mapping[str, Tool], project: Path | None) -> Mapping[str, Tool]:
    """All tools, or only those that the targets of ``project`` need."""
    if project is None:
        return tools
    bootstrap.ensure()  # reading the project's files needs the package for YAML
    from epg.connect.build.build_tools import tools_of_project

    wanted = {name: tools[name] for name in tools_of_project(project) if name in tools}
    return {
        name: tool for name, tool in wanted.items() if not any((project / file).is_file() for file in tool.in_project)
    }


def _report_project(items: list[ReportedTool], as_json: bool) -> int:
    """Prints the tools that one project needs.  The exit status depends only on these."""
    if as_json:
        sys.stdout.write(to_json({"items": [asdict(item) for item in items]}))
    elif items:
        print("\n".join(_lines(items)))
    else:
        print("no target with readable files was found: 'epg doctor' lists all tools")
    return 0 if all(item.good for item in items) else 4


def _home() -> str:
    return Path(epg.__file__).resolve().parent.as_posix()


def _cache_note(cache: Path) -> str:
    """A remark about EPG's cache: not used, not writable, or not yet there.  It is made when it is first needed."""
    problem = bootstrap.cache_problem(cache)
    if problem:
        return f" (EPG does not use it: {problem})"
    existing = next(folder for folder in (cache, *cache.absolute().parents) if folder.exists())
    if not os.access(existing, os.W_OK):
        return " (it cannot be written)"
    return "" if cache.is_dir() else " (it does not exist yet)"


_USES = {
    "plot": "for the plots of 'epg simulate' and 'epg plot'",
    "ros": "for 'epg record', if ROS 2 is not sourced",
    "mcap": "for 'epg record --mcap'",
}
"""The purposes of optional packages, by group."""


def _package(group: str, name: str, oldest: tuple[int, ...], *, required: bool) -> ReportedTool:
    """The report on a Python package, which can be installed in the interpreter or in EPG's cache."""
    note = _USES.get(group, "")
    old = ""
    for source, places in (("", sys.path), ("EPG's cache", [str(bootstrap.package_folder(group))])):
        distribution = next(iter(metadata.distributions(name=name, path=places)), None)
        if distribution is not None and bootstrap.version_numbers(distribution.version) >= oldest:
            path = Path(str(distribution.locate_file(""))).as_posix()
            return ReportedTool(name.lower(), name, HOST, required, "found", distribution.version, path, source, note)
        old = distribution.version if distribution is not None else old
    commands = package_commands([name])
    remedy = commands[0]
    if importlib.util.find_spec("pip") is not None and not os.environ.get("EPG_NO_INSTALL"):
        return ReportedTool(name.lower(), name, HOST, required, "later", old, note=note, remedy=remedy)
    if group not in ("ros", "mcap"):  # Debian has no packages of these groups
        remedy = commands[-1]
    return ReportedTool(name.lower(), name, HOST, required, "old" if old else "missing", old, note=note, remedy=remedy)


def _item(finding: Finding, where: Surroundings, tools: Mapping[str, Tool]) -> ReportedTool:
    """The report on a tool: its place and version, or the command that installs it."""
    tool = finding.tool
    if finding.status == "wrong":
        wanted = f"no {tool.holds}" if tool.holds else f"no {' or '.join(tool.programs)}"
        note, remedy = f"there is {wanted} at this path", f"correct or unset the {finding.source}"
    elif finding.status == "missing":
        note, remedy = f"looked in {', '.join(finding.looked)}; install it with:", command_for(tool, where, tools)
    elif finding.status == "old":
        note, remedy = f"{tool.oldest} or newer is needed; install it with:", command_for(tool, where, tools)
    else:
        differs = tool.tested and finding.version and not f"{finding.version}.".startswith(f"{tool.tested}.")
        note, remedy = f"tested with {tool.tested}" if differs else "", ""
    if not finding.asked:
        note = "its version is not known: --run starts the programs that this folder names, to read their versions"
    if tool.optional and not finding.path:
        note = f"{tool.optional}; {note}"
    return ReportedTool(
        name=tool.name,
        title=tool.title,
        needed_for=tool.needed_for,
        required=not tool.optional,
        status=finding.status,
        version=finding.version,
        path=finding.path.as_posix() if finding.path else "",
        source=finding.source,
        note=note,
        remedy=remedy,
    )


def _lines(items: Sequence[ReportedTool]) -> Iterable[str]:
    """The lines of the report.  Items for the same purpose are together; those for the host come first."""
    width = max(len(f"{item.title} {item.version}") for item in items)
    for group in sorted({item.needed_for for item in items}, key=lambda name: (name != HOST, name)):
        yield f"\n{group}"
        for item in (item for item in items if item.needed_for == group):
            named = f"{item.title} {item.version}".ljust(width)
            source = f"({item.source})" if item.source else ""
            place = "EPG installs it when it is first needed" if item.status == "later" else item.path
            yield "  ".join(part for part in (f"  {item.status:7s}", named, place, source) if part).rstrip()
            if item.note:
                yield f"           {item.note}"
            if not item.good:
                yield "           " + item.remedy.replace("\n", "\n           ")
