"""The command that gets a tool, by the package manager that this computer has."""

from __future__ import annotations

import os
import shutil
from pathlib import Path

from epg.load.tools import Tool

MANAGERS = {"apt": "apt-get", "dnf": "dnf", "pacman": "pacman", "brew": "brew", "winget": "winget"}
"""Package managers, and the program that shows that a computer has them."""


def command_for(tool: Tool, cache: Path) -> str:
    """The command that gets ``tool``; EPG's ``cache`` is where some of them go."""
    manager = package_manager()
    command = tool.get.get(manager) if manager else None
    prefix = privileged(manager) if command else ""
    folder = f'"{cache.as_posix()}"' if " " in cache.as_posix() else cache.as_posix()
    return prefix + (command or tool.get["any"]).replace("{cache}", folder)


def package_manager() -> str:
    """The package manager of this computer, or ""."""
    return next((name for name, program in MANAGERS.items() if shutil.which(program)), "")


def privileged(manager: str) -> str:
    """What makes a command of this package manager one of the system's administrator: "sudo " or ""."""
    root = hasattr(os, "geteuid") and os.geteuid() == 0
    return "" if root or manager in ("brew", "winget") else "sudo "
