# SPDX-License-Identifier: Apache-2.0
"""The files of the project, as git lists them."""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parent.parent


def listed(*arguments: str) -> list[str]:
    """The existing files that ``git ls-files`` lists, relative to the project.  Skips the test where it cannot."""
    if shutil.which("git") is None:
        pytest.skip("git is not installed: sudo apt install git")
    found = subprocess.run(["git", "-C", str(ROOT), "ls-files", *arguments], capture_output=True, text=True)
    if found.returncode != 0:
        pytest.skip("this folder is not a checkout of git")
    return [name for name in found.stdout.splitlines() if (ROOT / name).is_file()]
