# SPDX-License-Identifier: Apache-2.0
"""The module's sources pass the checks of Zephyr's maintainers."""

from __future__ import annotations

import re
import shutil
import subprocess
from pathlib import Path

import pytest

from tests.doubles.toolchain import ROOT, Missing, skip_if_missing, tool

FOLDERS = ("zephyr_module", "tests/zephyr")
KINDS = (".c", ".h", ".overlay", ".yaml", ".conf")
FILES = sorted(
    path
    for folder in FOLDERS
    for path in (ROOT / folder).rglob("*")
    if (path.suffix in KINDS or path.name in ("Kconfig", "CMakeLists.txt")) and "golden" not in path.parts
)


def zephyr() -> Path:
    return tool("zephyr")


def perl() -> str:
    program = shutil.which("perl")
    if program is None:
        raise Missing("perl, which checkpatch needs, is not installed: sudo apt install perl")
    return program


def test_checkpatch() -> None:
    skip_if_missing(zephyr, perl)
    command = [perl(), str(zephyr() / "scripts" / "checkpatch.pl"), "--no-tree", "--quiet", "-f", *map(str, FILES)]
    done = subprocess.run(command, capture_output=True, text=True, check=False, cwd=zephyr())
    assert re.findall(r"^(?:ERROR|WARNING):.*", done.stdout, re.MULTILINE) == [], done.stdout
    assert done.returncode == 0, done.stdout + done.stderr


@pytest.mark.parametrize("path", FILES, ids=lambda path: str(path.relative_to(ROOT)))
def test_licence(path: Path) -> None:
    """The licence lines that check_compliance.py requires."""
    text = path.read_text(encoding="utf-8")
    needs_none = path.suffix == ".conf" or path.name in ("testcase.yaml", "sample.yaml")
    assert needs_none or "SPDX-License-Identifier: Apache-2.0" in text
