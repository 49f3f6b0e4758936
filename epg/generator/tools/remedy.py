# SPDX-License-Identifier: Apache-2.0
"""The problem of a tool that a build cannot use, and the command that installs the tool on this computer."""

from __future__ import annotations

import re
import shutil
from collections.abc import Mapping

from epg.generator.install import privileged, system
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
    return "Get it:\n  " + command_for(tool, where, tools).replace("\n", "\n  ")


def command_for(tool: Tool, where: Surroundings, tools: Mapping[str, Tool]) -> str:
    """The command that installs ``tool``.  It can contain the paths of EPG's cache and of other ``tools``.

    On Windows it has a line for each program, because PowerShell 5.1 does not know ``&&``, and no ``~``.
    """
    manager = package_manager()
    command = tool.get.get(manager) if manager else None
    prefix = privileged(manager) if command else ""

    def quoted(path: str) -> str:
        # A shell also accepts quotes around a part of a word.
        return f'"{path}"' if " " in path else path

    def folder(match: re.Match[str]) -> str:
        return quoted(where.cache.as_posix() if match[1] == "cache" else _folder_of(tools[match[1]], where))

    names = "|".join(("cache", *map(re.escape, tools)))
    text = prefix + re.sub(rf"\{{({names})\}}", folder, command or tool.get["any"])
    if system() != "windows":
        return text
    return re.sub(r"(?<= )~(?=/)", lambda _: quoted(where.home.as_posix()), text).replace(" && ", "\n")


def _folder_of(tool: Tool, where: Surroundings) -> str:
    """The folder of ``tool``; if it is not found, the folder in which its command will install it."""
    finding = find_tool(tool, where)
    if finding.status == "found" and finding.path is not None:
        return finding.path.as_posix()
    return (where.cache / tool.cached.replace("*", tool.tested)).as_posix()


def package_manager() -> str:
    """The package manager of this computer, or "".  Windows 11 always has winget."""
    if system() == "windows":
        return "winget"
    return next((name for name, program in MANAGERS.items() if shutil.which(program)), "")
