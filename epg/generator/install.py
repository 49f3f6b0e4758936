# SPDX-License-Identifier: Apache-2.0
"""What a user must type or do differently on Linux, macOS and Windows, for messages and generated projects.

The commands that install a tool are in ``targets/tools/<tool>.json``; ``tools/remedy.py`` reads them.  CMake's files,
the README and ``docs/installing.md`` repeat the command that installs EPG; ``tests/docs/test_installing.py`` compares
them.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Mapping, Sequence

from epg.generator.system import here

ACTIVATE = ". ~/epg-environment/bin/activate"
"""The command that makes the program ``epg`` available in a terminal."""

_MAKE = "python3 -m venv ~/epg-environment"

LONGEST_PATH = 259
"""Characters of the longest path that Windows opens without its setting for long paths."""

REMEDIES: Mapping[str, Mapping[str, str]] = {
    "epg": {"windows": "py -m pip install {folder}", "any": f"{_MAKE} && {ACTIVATE} && pip install {{folder}}"},
    "port access": {
        "linux": "add yourself to its group: sudo usermod -aG dialout $USER, then log in again",
        "any": "let a user who may use it run EPG",
    },
    "board access": {
        "linux": "this user may not use the device: install the udev rules of {tool}, or add the user to the group "
        "'plugdev', and plug the board in again",
        "windows": "Windows has no driver with which {tool} can use the board: install WinUSB for it with Zadig "
        "(https://zadig.akeo.ie), and plug the board in again",
        "any": "{tool} could not use the board: plug it in again",
    },
    "long path": {
        "windows": "Windows opens paths of up to 259 characters, and this one has {length}: move the folder to a "
        "shorter path, such as C:\\work; or allow long paths as an administrator, and start Windows again: reg add "
        "HKLM\\SYSTEM\\CurrentControlSet\\Control\\FileSystem /v LongPathsEnabled /t REG_DWORD /d 1",
        "any": "",
    },
}
"""Purpose -> system -> what the user does.  "any" is for all systems that are not named."""


def system() -> str:
    """This computer's system: "linux", "macos" or "windows"."""
    return here.NAME


def remedy(purpose: str, **words: str) -> str:
    """What a user of this system does for ``purpose``; ``words`` are the values of the words in braces."""
    texts = REMEDIES[purpose]
    return texts.get(system(), texts["any"]).format(**words)


def long_path_remedy(path: str) -> str:
    """What the user does if ``path`` cannot be opened because it is too long for Windows; "" if it is not too long."""
    length = len(os.path.abspath(path))
    return remedy("long path", length=str(length)) if length > LONGEST_PATH else ""


def install_command(folder: str = "<folder of EPG>") -> str:
    """The command that installs EPG from ``folder``, a checkout, into a virtual environment of Linux or macOS.

    EPG is not on PyPI.  Debian and Ubuntu refuse ``pip install`` outside of a virtual environment (PEP 668).
    """
    return REMEDIES["epg"]["any"].format(folder=folder)


def package_commands(names: Sequence[str]) -> list[str]:
    """Commands that install Python packages for this interpreter: one of them is enough."""
    import shutil

    python = f'"{sys.executable}"' if " " in sys.executable else sys.executable
    commands = [f"{python} -m pip install {' '.join(names)}"]
    if system() == "linux" and shutil.which("apt-get"):
        packages = ("python3-" + name.lower().replace("pyyaml", "yaml") for name in names)
        commands.append(f"{privileged('apt')}apt install {' '.join(packages)}")
    return commands


def privileged(manager: str) -> str:
    """The prefix with which a command of a package manager runs as the administrator: "sudo " or ""."""
    return "" if here.is_administrator() or manager in ("brew", "winget") else "sudo "
