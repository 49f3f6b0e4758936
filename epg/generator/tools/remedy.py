# SPDX-License-Identifier: Apache-2.0
"""The problem of a tool that a build cannot use, and the command that installs the tool on this computer."""

from __future__ import annotations

import re
import shutil
from collections.abc import Mapping

from epg.generator.system import here
from epg.generator.tools.find_tool import Finding, Surroundings, find_tool
from epg.generator.tools.tools import Tool

MANAGERS = {"apt": "apt-get", "dnf": "dnf", "pacman": "pacman", "brew": "brew", "winget": "winget"}
"""Package manager -> the program that exists on computers with this package manager."""


def problem_of(finding: Finding) -> str:
    """The problem of a tool that a build cannot use, without a full stop; empty if the tool is found."""
    tool = finding.tool
    if finding.status == "wrong":
        wanted = f"{finding.path}/{tool.holds}" if tool.holds else f"{' or '.join(tool.programs)} in {finding.path}"
        return f"The {finding.source} does not lead to the {tool.title}: there is no {wanted}"
    if finding.status == "missing":
        return f"{tool.title} was not found{f' ({tool.optional})' if tool.optional else ''}"
    if finding.status == "old":
        return f"The {tool.title} in {finding.path} is {finding.version}; EPG needs {tool.oldest} or newer"
    return ""


def get_it(tool: Tool, where: Surroundings, tools: Mapping[str, Tool]) -> str:
    """The end of a message: "Get it:" and, on the next line, the command that installs ``tool``.

    CMake does not wrap a line of a message that begins with blanks.
    """
    return f"Get it:\n  {command_for(tool, where, tools)}"


def command_for(tool: Tool, where: Surroundings, tools: Mapping[str, Tool]) -> str:
    """The command that installs ``tool``.  It can contain the paths of EPG's cache and of other ``tools``."""
    manager = package_manager()
    command = tool.get.get(manager) if manager else None
    prefix = privileged(manager) if command else ""

    def folder(match: re.Match[str]) -> str:
        path = where.cache.as_posix() if match[1] == "cache" else _folder_of(tools[match[1]], where)
        # A shell also accepts quotes around a part of a word.
        return f'"{path}"' if " " in path else path

    names = "|".join(("cache", *map(re.escape, tools)))
    return prefix + re.sub(rf"\{{({names})\}}", folder, command or tool.get["any"])


def _folder_of(tool: Tool, where: Surroundings) -> str:
    """The folder of ``tool``; if it is not found, the folder in which its command will install it."""
    finding = find_tool(tool, where)
    if finding.status == "found" and finding.path is not None:
        return finding.path.as_posix()
    return (where.cache / tool.cached.replace("*", tool.tested)).as_posix()


def package_manager() -> str:
    """The package manager of this computer, or ""."""
    return next((name for name, program in MANAGERS.items() if shutil.which(program)), "")


def privileged(manager: str) -> str:
    """The prefix with which a command of this package manager runs as the administrator: "sudo " or ""."""
    return "" if here.is_administrator() or manager in ("brew", "winget") else "sudo "
