# SPDX-License-Identifier: Apache-2.0
"""docs/architecture.md: each part of the package imports only allowed parts, and each folder has a description."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
PAGE = (ROOT / "docs" / "architecture.md").read_text(encoding="utf-8")
PACKAGE = ROOT / "epg"


def floors() -> dict[str, int]:
    """The position of each part in the page's list, counted from the top."""
    block = next(block for block in PAGE.split("```")[1::2] if "documents" in block.split())
    return {room: number for number, line in enumerate(block.splitlines()) for room in line.split()}


def room_of(module: list[str]) -> str | None:
    """The part of the package to which a module belongs; None for ``epg`` itself."""
    return module[1] if len(module) > 1 else None


def imports(path: Path) -> Iterator[tuple[int, str | None]]:
    """The parts that a file of EPG imports, anywhere in the file, with their lines."""
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            names = [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{path}: a relative import"
            names = [f"{node.module}.{alias.name}" for alias in node.names]
        else:
            continue
        for name in (name.split(".") for name in names if name.split(".")[0] == "epg"):
            if name[1:] != ["__version__"]:
                yield node.lineno, room_of(name)


def test_imports_lead_down() -> None:
    floor = floors()
    wrong = []
    for path in sorted(PACKAGE.rglob("*.py")):
        module = list(path.relative_to(ROOT).with_suffix("").parts)
        room = room_of(module)
        for line, imported in imports(path):
            if room == "__init__" or imported is None or imported == room:
                continue
            if floor[imported] <= floor[room or ""]:
                wrong.append(f"{path.relative_to(ROOT)}:{line}: {room} imports {imported}")
    assert wrong == []


def test_the_list_names_every_part_once() -> None:
    there = {path.stem for path in PACKAGE.iterdir() if path.suffix == ".py" and path.stem != "__init__"}
    there |= {path.parent.name for path in PACKAGE.glob("*/__init__.py")}
    block = next(block for block in PAGE.split("```")[1::2] if "documents" in block.split())
    assert sorted(block.split()) == sorted(there)


def test_the_table_describes_every_folder_of_the_package() -> None:
    described = set(re.findall(r"^\| `epg/(\w+)` \|", PAGE, re.MULTILINE))
    assert described == {path.parent.name for path in PACKAGE.glob("*/__init__.py")}
