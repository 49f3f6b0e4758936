# SPDX-License-Identifier: Apache-2.0
"""The tables of events in ``docs/concepts.md``: no fault, stop or guard is missing, and each row names a test."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
import yaml

from tests.mutants.safety.programs import names_of

ROOT = Path(__file__).resolve().parents[2]
RUNTIME = ROOT / "targets" / "runtime"


def rows_of(column: str) -> list[list[str]]:
    """The rows of the table whose second column has this title, split into cells."""
    page = (ROOT / "docs" / "concepts.md").read_text(encoding="utf-8")
    found = re.findall(rf"^\|[^|\n]*\| {column} \| test \|\n\|---\|---\|---\|\n((?:\|.*\n)+)", page, re.MULTILINE)
    assert len(found) == 1
    return [[cell.strip() for cell in line.strip("|").split("|")] for line in found[0].splitlines()]


STOPS, FAULTS, OTHERS = (rows_of(column) for column in ("origin", "fault", "effect"))


def kinds() -> dict[str, set[str]]:
    """The faults of each kind of component that declares some."""
    files = (ROOT / "targets" / "components").glob("*/component.yaml")
    found = {path.parent.name: yaml.safe_load(path.read_text(encoding="utf-8")).get("faults", {}) for path in files}
    return {kind: set(faults) for kind, faults in found.items() if faults}


def names(rows: list[list[str]]) -> list[str]:
    return sorted(row[1].strip("`") for row in rows)


def test_each_stop_has_a_row() -> None:
    enum = re.findall(r"^    (EPG_STOP_\w+),", (RUNTIME / "include" / "epg" / "status.h").read_text(), re.MULTILINE)
    texts = (RUNTIME / "src" / "communication" / "fault.c").read_text(encoding="utf-8")
    shown = dict(re.findall(r'\[(EPG_STOP_\w+)\] = "([\w-]+)"', texts))
    assert set(enum) == set(shown)
    assert names(STOPS) == sorted(shown.values())


def test_each_fault_has_a_row() -> None:
    runtime = yaml.safe_load((RUNTIME / "faults.yaml").read_text(encoding="utf-8"))
    enum = re.findall(r"^    EPG_FAULT_(\w+)(?: = \d+)?,", (RUNTIME / "include/epg/fault.h").read_text(), re.MULTILINE)
    assert len(runtime) == len(enum) - 1, "all but EPG_FAULT_NONE"
    assert names(FAULTS) == sorted({*runtime, *(fault for faults in kinds().values() for fault in faults)})


@pytest.mark.parametrize("kind", sorted(kinds()))
def test_the_rows_of_a_guard_name_it(kind: str) -> None:
    assert {row[1].strip("`") for row in FAULTS if f"`{kind}`" in row[0]} == kinds()[kind]


@pytest.mark.parametrize("row", [*STOPS, *FAULTS, *OTHERS], ids=lambda row: row[0])
def test_each_row_names_a_test(row: list[str]) -> None:
    name = row[2].strip("`")
    if "::" in name:
        file, _, function = name.partition("::")
        assert f"def {function}(" in (ROOT / file).read_text(encoding="utf-8")
    else:
        program, _, test = name.partition("/")
        assert test in names_of(program)
