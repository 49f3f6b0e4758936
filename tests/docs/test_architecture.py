# SPDX-License-Identifier: Apache-2.0
"""docs/architecture.md: each part of the package imports only allowed parts, and each folder has a description."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from functools import cache
from pathlib import Path

from epg.generator.emit.macros import MACROS

ROOT = Path(__file__).resolve().parents[2]
PAGE = (ROOT / "docs" / "architecture.md").read_text(encoding="utf-8")
PACKAGE = ROOT / "epg"
GENERATOR = PACKAGE / "generator"
BASE = {"generator", "runs", "edit"}


def floors() -> dict[str, int]:
    """The position of each part of the generator in the page's list, counted from the top."""
    block = next(block for block in PAGE.split("```")[1::2] if "dataclass" in block.split())
    return {room: number for number, line in enumerate(block.splitlines()) for room in line.split()}


def annexes() -> dict[str, set[str]]:
    """The parts that each annex may import, of the page's table."""
    table = PAGE[PAGE.index("| annex | imports besides |") :].split("\n\n")[0]
    rows = [[cell.strip() for cell in line.strip("|").split("|")] for line in table.splitlines()[2:]]
    allowed = {}
    for names, besides in rows:
        for name in re.findall(r"`(\w+)`", names):
            allowed[name] = BASE | set(re.findall(r"`(\w+)`", besides))
    allowed["runs"] = allowed["edit"] = {"generator"}
    allowed["connect"] = set(allowed) | {"generator"} - {"cli"}
    allowed["cli"] = set(allowed) | {"generator"}
    return allowed


def parts(folder: Path) -> set[str]:
    """The modules and packages of a folder."""
    there = {path.stem for path in folder.iterdir() if path.suffix == ".py" and not path.stem.startswith("__")}
    return there | {path.parent.name for path in folder.glob("*/__init__.py")}


@cache
def imports(place: Path) -> list[tuple[str, list[str]]]:
    """Each import of EPG's own modules in a file or folder: its place, and the parts of the imported name."""
    return list(_imports(place))


def _imports(place: Path) -> Iterator[tuple[str, list[str]]]:
    for path in sorted(place.rglob("*.py")) if place.is_dir() else [place]:
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.Import):
                names = [alias.name for alias in node.names]
            elif isinstance(node, ast.ImportFrom):
                assert node.level == 0, f"{path}: a relative import"
                names = [f"{node.module}.{alias.name}" for alias in node.names]
            else:
                continue
            for name in (name.split(".") for name in names if name.split(".")[0] == "epg"):
                if name[1:] not in ([], ["__version__"]):
                    yield f"{path.relative_to(ROOT)}:{node.lineno}", name[1:]


def test_the_generator_imports_nothing_else() -> None:
    assert [place for place, name in imports(GENERATOR) if name[0] != "generator"] == []


def test_imports_inside_the_generator_lead_down() -> None:
    floor = floors()
    wrong = []
    for part in sorted(floor):
        folder = GENERATOR / part
        for place, name in imports(folder if folder.is_dir() else folder.with_suffix(".py")):
            if name[1] != part and floor[name[1]] <= floor[part]:
                wrong.append(f"{place}: {part} imports {name[1]}")
    assert wrong == []


def test_annexes_import_only_the_parts_in_the_table() -> None:
    wrong = []
    for annex, allowed in annexes().items():
        for place, name in imports(PACKAGE / annex):
            if name[0] != annex and name[0] not in allowed:
                wrong.append(f"{place}: {annex} imports {name[0]}")
    assert wrong == []


def test_the_lists_name_every_part_once() -> None:
    assert set(floors()) == parts(GENERATOR)
    assert set(annexes()) | {"generator"} == parts(PACKAGE)


def test_the_table_describes_every_folder_of_the_package() -> None:
    described = set(re.findall(r"^\| `epg/((?:generator/)?\w+)` \|", PAGE, re.MULTILINE))
    there = {path.parent.relative_to(PACKAGE).as_posix() for path in PACKAGE.glob("*/__init__.py")} - {"generator"}
    assert described == there | {f"generator/{path.parent.name}" for path in GENERATOR.glob("*/__init__.py")}


def test_the_table_of_macros_has_those_that_epg_calls() -> None:
    table = PAGE.split("| macro | gives | place |")[1].split("\n\n")[0]
    named = [name for row in table.splitlines() for name in re.findall(r"`(\w+)\(c", row.split(" | ")[0])]
    assert sorted(named) == MACROS
