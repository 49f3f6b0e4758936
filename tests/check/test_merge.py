# SPDX-License-Identifier: Apache-2.0
"""Files that extend each other: mappings merge, lists and scalars replace, null deletes, positions stay."""

from __future__ import annotations

from pathlib import Path

import pytest

from epg.generator.check.merge import apply_settings, merge_chain
from epg.generator.diagnostics import Diagnostics
from epg.generator.documents.tcf import load_tcf_chain, settings_node
from epg.generator.source import Span, YamlNode


def merged(folder: Path, name: str, *settings: str, wanted_by: Span | None = None) -> YamlNode:
    problems = Diagnostics()
    chain = load_tcf_chain(name, [], problems, beside=folder, wanted_by=wanted_by)
    root = apply_settings(merge_chain(chain), settings_node([(s, Span("CMakeLists.txt")) for s in settings], problems))
    assert not list(problems)
    return root


@pytest.fixture
def files(tmp_path: Path) -> Path:
    (tmp_path / "robot.tcf").write_text("a: {x: 1, y: 2}\nl: [1, 2]\ngone: {z: 1}\n")
    (tmp_path / "wiring.tcf").write_text("extends: robot.tcf\na: {y: 3, z: 4}\nl: [3]\n")
    (tmp_path / "target.tcf").write_text("extends: wiring.tcf\ngone: null\na: {z: 5}\n")
    return tmp_path


def test_the_merge(files: Path) -> None:
    assert merged(files, "target.tcf").plain() == {"a": {"x": 1, "y": 3, "z": 5}, "l": [3]}


def test_values_keep_the_position_of_the_file_that_wrote_them(files: Path) -> None:
    root = merged(files, "target.tcf")
    assert root["a"]["x"].span == Span(str(files / "robot.tcf"), 1, 8, 9)
    assert root["a"]["y"].span == Span(str(files / "wiring.tcf"), 2, 8, 9)
    assert root["a"].key_span("z") == Span(str(files / "target.tcf"), 3, 5, 6)


def test_an_inherited_value_knows_who_inherits_it_nearest_first(files: Path) -> None:
    """The position at which CMake or a system names the first file is none of an ``extends``."""
    for wanted_by in (None, Span("CMakeLists.txt", 3)):
        tree = merged(files, "target.tcf", wanted_by=wanted_by)["a"]
        origins = [[(Path(span.file).name, span.line) for span in tree[key].origins] for key in ("x", "y", "z")]
        assert origins == [[("wiring.tcf", 1), ("target.tcf", 1)], [("target.tcf", 1)], []]


def test_settings_come_last_and_may_make_or_delete_keys(files: Path) -> None:
    root = merged(files, "target.tcf", "a.y=7", "new.deep.key=on", "l=null", "a.x=2 ms")
    assert root.plain() == {"a": {"x": "2 ms", "y": 7, "z": 5}, "new": {"deep": {"key": "on"}}}
    assert root["a"]["y"].span.file == "CMakeLists.txt"


def test_a_file_that_extends_itself(tmp_path: Path) -> None:
    (tmp_path / "a.tcf").write_text("extends: b.tcf\n")
    (tmp_path / "b.tcf").write_text("extends: a.tcf\n")
    problems = Diagnostics()
    assert load_tcf_chain("a.tcf", [], problems, beside=tmp_path) == ()
    (problem,) = problems
    assert (problem.id, Path(problem.span.file).name) == ("extends-loop", "b.tcf")
