# SPDX-License-Identifier: Apache-2.0
"""Mistakes in YAML: the wrong line and its correction, with libyaml's parser and with PyYAML's own."""

from __future__ import annotations

import pytest
import yaml

from epg.generator.diagnostics import Diagnostics
from epg.generator.documents import yaml_file
from epg.generator.documents.yaml_file import parse_yaml

MISTAKES = [
    ("control:\n\tperiod: 1 ms\n", 2, 1, "tab", "spaces"),
    ("control:\n  a: 1 ms\n\tb: 2\n", 3, 1, "tab", "spaces"),
    ("control:\n  \ta: 1 ms\n  b: 2\n", 2, 3, "tab", "spaces"),
    ("a: 1\n b: 2\n", 2, 2, "indentation: 1 space", "no space before it, as in line 1"),
    ("  a: 1\nb: 2\n", 1, 3, "indentation: 2 spaces", "no space before it, as in line 2"),
    ("---\na:\n  b: {}\n   c: {}\n  d: {}\n", 4, 4, "indentation: 3 spaces", "2 spaces before it, as in line 3"),
    ("a:\n  b: {}\n c: {}\n", 3, 2, "indentation: 1 space", "2 spaces before it, as in line 2"),
    ("a:\n   b: {}\n  c: {}\n  d: {}\n", 2, 4, "indentation: 3 spaces", "2 spaces before it, as in line 3"),
    ("x:\n  y: 1\na:\n   b: {}\n  c: {}\n", 4, 4, "indentation: 3 spaces", "2 spaces before it, as in line 5"),
    ("a:\n  b: |\n    text: x\n  text\n   c: 1\nd: 2\n", 4, 3, "'text' has no ':'", "'text:'"),
    ("a:\n- b: 1\n   c: 2\n", 3, 4, "indentation: 3 spaces", "2 spaces"),
    ("a:\nb: 1\n  c: 2\n", 3, 3, "indentation: 2 spaces", "no space"),
    ("version 1\ntarget: host\n", 1, 1, "'version 1' has no ':'", "'version: 1'"),
    ("a: 1\ntarget host # the computer\nb: 2\n", 2, 1, "'target host' has no ':'", "'target: host'"),
    ("a: 1\ntarget host", 2, 1, "'target host' has no ':'", "'target: host'"),
    ("a:\n  b 1 ms\n  c: 2\n", 2, 3, "'b 1 ms' has no ':'", "'b: 1 ms'"),
    ("components\n  a: {}\n", 1, 1, "'components' has no ':'", "'components:'"),
    ("a = 1\nb: 2\n", 1, 1, "'a = 1' has '=' instead", "'a: 1'"),
    ("a: 1\nb=x\nc: 2\n", 2, 1, "'b=x' has '=' instead", "'b: x'"),
    ("a: {b = 1 ms}\n", 1, 5, "'b = 1 ms' has '=' instead", "'b: 1 ms'"),
    ("a: {b 1 ms, c: 2}\n", 1, 5, "'b 1 ms' has no ':'", "'b: 1 ms'"),
    ("a: {b:1 ms}\n", 1, 5, "no space after ':'", "'b: 1 ms'"),
    ("a: 1\nb:x\nc: 2\n", 2, 1, "no space after ':'", "'b: x'"),
    ("a: {b: 1,5 ms, c: 2}\n", 1, 8, "'1,5 ms' is written with a decimal comma", "'1.5 ms'"),
    ("a: {b: -0,25}\n", 1, 8, "'-0,25' is written with a decimal comma", "'-0.25'"),
    ("// x\na: 1\n", 1, 1, "'//'", "'# x'"),
    ("a: 1\n// x\nb: 2\n", 2, 1, "'//'", "'# x'"),
    ("a: host // x\n", 1, 9, "'//'", "'# x'"),
    ("a: host\n  // x\n", 2, 3, "'//'", "'# x'"),
    ('a: "host" // x\n', 1, 11, "'//'", "'# x'"),
    ("a: {b: 1} // x\nc: 1\n", 1, 11, "'//'", "'# x'"),
    ("/* x */\na: 1\n", 1, 1, "'/*'", "'# x'"),
    ('a: "x\nb: 1\n', 1, 4, "quote is not closed", 'write "'),
    ("a: {b: [1, 2}\nc: d\n", 1, 8, "bracket is not closed", "write ]"),
    ("a: {b: 1\nc: d\n", 1, 4, "bracket is not closed", "write }"),
    ("a: {b: 1}}\n", 1, 10, "'}' is after", "remove"),
    ("a: b: c\n", 1, 5, "a second ':'", "quote"),
    ("a: @x\n", 1, 4, "cannot begin with '@'", '"@x"'),
]


@pytest.mark.parametrize("loader", [yaml_file.LOADER, yaml.SafeLoader], ids=["libyaml", "pyyaml"])
@pytest.mark.parametrize(("text", "line", "column", "message", "hint"), MISTAKES, ids=lambda value: repr(value)[:40])
def test_mistake(
    text: str, line: int, column: int, message: str, hint: str, loader: object, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(yaml_file, "LOADER", loader)
    diagnostics = Diagnostics()
    assert parse_yaml(text, "f.yaml", diagnostics) is None
    (problem,) = diagnostics
    assert (problem.id, problem.span.line, problem.span.column) == ("yaml-syntax", line, column)
    assert message in problem.message
    assert hint in problem.hint


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("a: http://x/y\n", "http://x/y"),
        ('a: "x // y"\n', "x // y"),
        ("a: |\n  // x\n", "// x\n"),
        ("a: x # // y\n", "x"),
        ("a: {b: 1, c: 2}\n", {"b": 1, "c": 2}),
        ("a: {b: 1, c: , d: 2}\n", {"b": 1, "c": None, "d": 2}),
        ("a: [1,5, x y]\n", [1, 5, "x y"]),
        ("a:\n  several words\n  in two lines\n", "several words in two lines"),
    ],
)
def test_right_text_is_taken(text: str, value: object) -> None:
    diagnostics = Diagnostics()
    node = parse_yaml(text, "f.yaml", diagnostics)
    assert not list(diagnostics)
    assert node is not None
    assert node["a"].plain() == value


@pytest.mark.parametrize("text", ["a: " + " " * 200_000 + "{", "a\n" * 50_000 + "b: [", "[" * 30 + " //" * 50_000])
def test_long_text_takes_no_time(text: str) -> None:
    diagnostics = Diagnostics()
    assert parse_yaml(text, "f.yaml", diagnostics) is None
    assert len(list(diagnostics)) == 1
