# SPDX-License-Identifier: Apache-2.0
"""docs/files.md lists the required keys as the schemas and the kinds do."""

from __future__ import annotations

import json
from pathlib import Path

from epg.cli.main import main
from epg.generator.catalog.catalog import Kind, load_catalog
from epg.generator.data import data_folder
from epg.generator.diagnostics import Diagnostics
from epg.generator.documents.schema import load_schema

FILES_PAGE = Path(__file__).resolve().parents[2] / "docs" / "files.md"


def _list(names: list[str]) -> str:
    return ", ".join(f"`{name}`" for name in names)


def _required(kind: Kind) -> str:
    """The required keys of a component of ``kind``, besides ``kind``, in the words of the page."""
    names = [f"pins: {{{', '.join(kind.pins)}}}"] if kind.pins else []
    names += [parameter.name for parameter in kind.parameters if parameter.required]
    names += [use.name for use in kind.uses if use.required]
    parts = [_list(names)] if names else []
    parts += [f"either {_list(list(group)).replace(', ', ' or ')}" for group in kind.exactly_one]
    parts += [f"at least one of {_list(list(group))}" for group in kind.at_least_one]
    return "; ".join(parts) or "nothing"


def test_the_page_names_the_required_keys_of_each_kind() -> None:
    diagnostics = Diagnostics()
    catalog = load_catalog([data_folder("targets")], diagnostics)
    page = FILES_PAGE.read_text(encoding="utf-8")
    rows = {}
    for name in catalog.kind_names():
        kind = catalog.find_kind(name)
        assert kind is not None
        rows[f"| `{name}` | {_required(kind)} |"] = name
    assert [row for row in rows if row not in page] == []
    assert not diagnostics.has_errors


def test_the_page_names_the_required_keys_of_each_block() -> None:
    page = FILES_PAGE.read_text(encoding="utf-8")
    tcf, bindings = load_schema("tcf"), load_schema("bindings")
    assert f"| a `.tcf` | {_list(tcf['required'])} |" in page
    assert all("required" not in tcf["properties"][block] for block in ("control", "communication"))
    assert "| `control`, `communication` | nothing" in page
    assert f"| bindings | {_list(bindings['required'])}" in page


def test_a_target_without_control_starts_disabled_at_the_step_of_the_model(tmp_path: Path) -> None:
    common = Path(__file__).resolve().parents[1] / "errors" / "common"
    robot = (common / "robot.tcf").read_text(encoding="utf-8")
    assert "control: {period: 1 ms, enable_at_start: false}\n" in robot
    (tmp_path / "robot.tcf").write_text(robot.replace("control: {period: 1 ms, enable_at_start: false}\n", ""))
    described = []
    for tcf in (common / "robot.tcf", tmp_path / "robot.tcf"):
        files = ["--tcf", tcf, "--model", common / "model", "--bindings", common / "bindings.yaml"]
        assert main(["generate", "robot", *map(str, files), "--output", str(tmp_path / "out")]) == 0
        described.append(json.loads((tmp_path / "out" / "robot.json").read_text(encoding="utf-8"))["control"])
    assert described[0] == described[1]
    assert described[1]["enable_at_start"] is False
    assert described[1]["period"] == 0.001
