# SPDX-License-Identifier: Apache-2.0
"""Each double can be used without the tests around it: its imports, and its README."""

from __future__ import annotations

import ast
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

DOUBLES = Path(__file__).resolve().parent
ROOT = DOUBLES.parents[1]
NAMES = sorted(folder.name for folder in DOUBLES.iterdir() if folder.is_dir() and folder.name != "__pycache__")
WORDS = 120
"""Limit for a README."""


def outside(source: str) -> list[str]:
    """The modules of the tests that a module of a double imports, other than doubles."""
    found = []
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Import):
            found += [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            found.append(f"..{node.module}" if node.level > 1 else node.module or "")
    return [name for name in found if re.match(r"\.\.|benchmarks|tests\b(?!\.doubles\b)", name)]


def test_an_import_of_the_tests_is_found() -> None:
    assert outside("import tests.waiting\nfrom tests.doubles.toolchain import tool\nimport os") == ["tests.waiting"]
    assert outside("def f():\n    from tests.ros2 import network\nfrom ..waiting import until") == [
        "..waiting",
        "tests.ros2",
    ]


def test_no_double_imports_the_tests_around_it() -> None:
    sources = [path for path in DOUBLES.rglob("*.py") if not path.name.startswith("test_")]
    found = {path.name: outside(path.read_text(encoding="utf-8")) for path in sources}
    assert len(sources) > 50 and {name: names for name, names in found.items() if names} == {}


@pytest.mark.parametrize("name", NAMES)
def test_readme(name: str) -> None:
    text = (DOUBLES / name / "README.md").read_text(encoding="utf-8")
    assert len(text.split()) <= WORDS


def test_another_project_can_import_them(tmp_path: Path) -> None:
    """The imports in the READMEs work beside a copy of the doubles, without the rest of the tests."""
    shutil.copytree(DOUBLES, tmp_path / "tests" / "doubles", ignore=shutil.ignore_patterns("test_*", "conftest.py"))
    (tmp_path / "epg").symlink_to(ROOT / "epg")
    texts = [(DOUBLES / name / "README.md").read_text(encoding="utf-8") for name in NAMES if name != "ros2_peer"]
    imports = re.findall(r"^from tests\..*", "\n".join(texts), re.MULTILINE)
    assert len(imports) >= 7
    packages = [folder for folder in sys.path if folder and not Path(folder).is_relative_to(ROOT)]
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join([str(tmp_path), *packages])}
    command = [sys.executable, "-c", "\n".join(imports)]
    done = subprocess.run(command, capture_output=True, text=True, env=environment, cwd=tmp_path)
    assert done.returncode == 0, done.stderr
