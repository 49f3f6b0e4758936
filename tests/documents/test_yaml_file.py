# SPDX-License-Identifier: Apache-2.0
"""YAML 1.2 scalars, positions, and limits that are checked before any recursion."""

from __future__ import annotations

import math
from pathlib import Path

import pytest

from epg.generator import install
from epg.generator.diagnostics import Diagnostics
from epg.generator.documents.yaml_file import load_yaml, parse_yaml
from epg.generator.source import Span, YamlNode


def parse(text: str) -> YamlNode:
    problems = Diagnostics()
    node = parse_yaml(text, "x.yaml", problems)
    assert not list(problems)
    assert node is not None
    return node


def ids(text: str) -> list[str]:
    problems = Diagnostics()
    assert parse_yaml(text, "x.yaml", problems) is None
    return [problem.id for problem in problems]


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("on", "on"),
        ("yes", "yes"),
        ("true", True),
        ("False", False),
        ("~", None),
        ("1e3", 1000.0),
        ("1_000", "1_000"),
        ("12:30:00", "12:30:00"),
        ("0x1F", 31),
        ("0o17", 15),
        ("-.5", -0.5),
        ("+7", 7),
        ("0", 0),
        ("2026-11-21", "2026-11-21"),
        ("'1'", "1"),
        ("-.inf", -math.inf),
        ("=", "="),
        ("1.0.0", "1.0.0"),
    ],
)
def test_scalars_are_those_of_yaml_1_2(text: str, value: object) -> None:
    found = parse(f"a: {text}\n")["a"].value
    assert found == value
    assert type(found) is type(value)


def test_nan_is_a_number() -> None:
    value = parse("a: .nan\n")["a"].value
    assert isinstance(value, float)
    assert math.isnan(value)


def test_every_value_and_key_knows_its_place() -> None:
    root = parse("a: 1\nb:\n  - {c: two words}\n")
    assert root["b"][0]["c"].span == Span("x.yaml", 3, 9, 18)
    assert root["b"][0].key_span("c") == Span("x.yaml", 3, 6, 7)
    assert root.key_span("b") == Span("x.yaml", 2, 1, 2)


def test_columns_count_characters_and_windows_line_ends_are_one() -> None:
    root = parse("a: 'µµ'\r\nb: {ü: 1}\r\n")
    assert root["b"]["ü"].span == Span("x.yaml", 2, 8, 9)


def test_an_empty_file_is_null() -> None:
    assert parse("").value is None
    assert parse("# only a comment\n").value is None


@pytest.mark.parametrize(
    ("text", "id"),
    [
        ("a: 1\na: 2\n", "duplicate-key"),
        ("a: 010\n", "yaml-1.1-trap"),
        ("a: &x 1\nb: *x\n", "yaml-alias"),
        ("a: !!python/object:os.system x\n", "yaml-tag"),
        ("---\na: 1\n---\nb: 2\n", "yaml-documents"),
        ("? [a]\n: 1\n", "yaml-key"),
        ("[" * 25_000, "yaml-depth"),
        ("a: " * 25_000, "yaml-syntax"),
        ("\t- a", "yaml-syntax"),
        ("a: {b", "yaml-syntax"),
    ],
)
def test_what_is_refused(text: str, id: str) -> None:
    assert ids(text) == [id]


def test_the_second_of_two_equal_keys_is_reported_with_the_first() -> None:
    problems = Diagnostics()
    parse_yaml("a: 1\nb: {c: 1,\n c: 2}\n", "x.yaml", problems)
    (problem,) = problems
    assert problem.span == Span("x.yaml", 3, 2, 3)
    assert problem.notes[0].span == Span("x.yaml", 2, 5, 6)


@pytest.mark.parametrize(
    ("data", "id"),
    [
        (b"a: \xff\n", "not-utf-8"),
        (b"\xff\xfea\x00", "not-utf-8"),
        (b"a: \x00\n", "control-character"),
        (b"a: 1\n" * 300_000, "file-too-large"),
    ],
)
def test_files_that_are_no_text(tmp_path: Path, data: bytes, id: str) -> None:
    path = tmp_path / "x.yaml"
    path.write_bytes(data)
    problems = Diagnostics()
    assert load_yaml(path, problems) is None
    assert [problem.id for problem in problems] == [id]


def test_a_byte_order_mark_is_no_character(tmp_path: Path) -> None:
    path = tmp_path / "x.yaml"
    path.write_bytes(b"\xef\xbb\xbfa: 1\n")
    problems = Diagnostics()
    node = load_yaml(path, problems)
    assert node is not None
    assert node["a"].span.column == 4


def test_a_missing_file_names_its_neighbours(tmp_path: Path) -> None:
    (tmp_path / "robot.yaml").write_text("a: 1\n")
    problems = Diagnostics()
    assert load_yaml(tmp_path / "robto.yaml", problems) is None
    (problem,) = problems
    assert problem.id == "file-not-found"
    assert "robot.yaml" in problem.hint


@pytest.mark.parametrize(
    ("system", "length", "remedy"), [("windows", 260, True), ("windows", 259, False), ("linux", 300, False)]
)
def test_a_path_that_windows_finds_too_long(
    system: str, length: int, remedy: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(install, "system", lambda: system)
    problems = Diagnostics()
    load_yaml(Path((Path.cwd().anchor + "nowhere12/" * length)[:length]), problems)
    (problem,) = problems
    told = f"Windows opens paths of up to 259 characters, and this one has {length}: "
    assert problem.id == "file-not-found"
    assert problem.hint.startswith(told) == remedy
    assert ("move the folder to a shorter path" in problem.hint) == ("LongPathsEnabled" in problem.hint) == remedy
