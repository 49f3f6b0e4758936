# SPDX-License-Identifier: Apache-2.0
"""EPG needs CMake 3.22: every project, preset and page states this version."""

from __future__ import annotations

import re
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
FOLDERS = ("cmake", "docs", "examples", "integration", "targets", "tests", "zephyr_module")
NAMES = ("CMakeLists.txt*", "*.cmake", "*.md", "*.md.j2", "CMakePresets.json*")
REQUIRED = re.compile(r"cmake_minimum_required\(VERSION ([0-9]+[.][0-9]+)|\"cmakeMinimumRequired\": \{([^}]*)\}")
NEEDED = ("3.22", '"major": 3, "minor": 22, "patch": 0')


def test_every_required_version_is_the_one_epg_needs() -> None:
    files = [path for folder in FOLDERS for name in NAMES for path in sorted((ROOT / folder).rglob(name))]
    found = {
        (path.relative_to(ROOT).as_posix(), match[1] or match[2])
        for path in [ROOT / "CMakeLists.txt", ROOT / "README.md", *files]
        for match in REQUIRED.finditer(path.read_text(encoding="utf-8"))
    }
    assert len(found) > 30
    assert {entry for entry in found if entry[1] not in NEEDED} == set()
