# SPDX-License-Identifier: Apache-2.0
"""The command that gets a tool, by the package manager that this computer has."""

from __future__ import annotations

import os
import re
import shutil
from collections.abc import Mapping

from epg.tools.find_tool import Surroundings, find_tool
from epg.tools.tools import Tool

MANAGERS = {"apt": "apt-get", "dnf": "dnf", "pacman": "pacman", "brew": "brew", "winget": "winget"}
"""Package managers, and the program that shows that a computer has them."""


def command_for(tool: Tool, where: Surroundings, tools: Mapping[str, Tool]) -> str:
    """The command that gets ``tool``; it may name EPG's cache and the folders of other ``tools``."""
    manager = package_manager()
    command = tool.get.get(manager) if manager else None
    prefix = privileged(manager) if command else ""

    def folder(match: re.Match[str]) -> str:
        path = where.cache.as_posix() if match[1] == "cache" else _folder_of(tools[match[1]], where)
        # Quotes around a part of a word do for a shell.
        return f'"{path}"' if " " in path else path

    names = "|".join(("cache", *map(re.escape, tools)))
    return prefix + re.sub(rf"\{{({names})\}}", folder, command or tool.get["any"])


def _folder_of(tool: Tool, where: Surroundings) -> str:
    """Where ``tool`` is, or where its command will put it."""
    found = find_tool(tool, where)
    if found.status == "found" and found.path is not None:
        return found.path.as_posix()
    return (where.cache / tool.cached.replace("*", tool.tested)).as_posix()


def package_manager() -> str:
    """The package manager of this computer, or ""."""
    return next((name for name, program in MANAGERS.items() if shutil.which(program)), "")


def privileged(manager: str) -> str:
    """What makes a command of this package manager one of the system's administrator: "sudo " or ""."""
    root = hasattr(os, "geteuid") and os.geteuid() == 0
    return "" if root or manager in ("brew", "winget") else "sudo "
