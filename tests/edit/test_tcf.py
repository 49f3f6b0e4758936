# SPDX-License-Identifier: Apache-2.0
"""Changing the file that a .tcf extends, and leaving out parts of it: all other lines stay."""

from __future__ import annotations

import doctest
from pathlib import Path

import pytest

import epg.edit.tcf
from epg.diagnostics import Diagnostics
from epg.documents.yaml_file import parse_yaml
from epg.edit.tcf import leave_out, set_extends
from epg.edit.yaml_edit import CannotEdit

ROOT = Path(__file__).resolve().parents[2]
CONFIGURATIONS = sorted([*ROOT.glob("examples/**/*.tcf"), *ROOT.glob("targets/**/*.tcf")])

EXAMPLES = {
    "quotes stay": ('{"version": 1, "extends": "a.tcf"}', "b.tcf", '{"version": 1, "extends": "b.tcf"}'),
    "on the next line": ("extends:\n  a.tcf   # here\nnode: x\n", "b.tcf", "extends:\n  b.tcf   # here\nnode: x\n"),
    "nothing said": ("version: 1\nextends:   # which?\n", "b.tcf", "version: 1\nextends: b.tcf   # which?\n"),
    "null": ("extends: null\r\nnode: x", "b.tcf", "extends: b.tcf\r\nnode: x"),
    "not there": ("version: 1   # of EPG\n\nnode: x\n", "b.tcf", "version: 1   # of EPG\nextends: b.tcf\n\nnode: x\n"),
    "no version either": ("# mine\nnode: x\n", "b.tcf", "# mine\nextends: b.tcf\nnode: x\n"),
    "in braces": ("{version: 1}\n", "b.tcf", "{version: 1, extends: b.tcf}\n"),
    "a path": ("extends: a.tcf\n", "../my-robots/a_b.tcf", "extends: ../my-robots/a_b.tcf\n"),
    "a name with all there is": ("extends: a.tcf\n", "my 'robot': #1.tcf", "extends: 'my ''robot'': #1.tcf'\n"),
    "a name with a line end": ("extends: a.tcf\n", "a\nnode: b", 'extends: "a\\u000Anode: b"\n'),
    "the same": ("extends:  'a.tcf'\n", "a.tcf", "extends:  'a.tcf'\n"),
}


@pytest.mark.parametrize("what", EXAMPLES)
def test_only_that_changes(what: str) -> None:
    before, name, after = EXAMPLES[what]
    assert set_extends(before, "robot.tcf", name) == after
    assert set_extends("\ufeff" + before, "robot.tcf", name) == "\ufeff" + after
    root = parse_yaml(after, "robot.tcf", Diagnostics())
    assert root is not None and root["extends"].value == name


@pytest.mark.parametrize("path", CONFIGURATIONS, ids=lambda path: path.name)
def test_there_and_back(path: Path) -> None:
    text = path.read_text(encoding="utf-8")
    root = parse_yaml(text, path.name, Diagnostics())
    assert root is not None
    changed = set_extends(text, path.name, "another.tcf")
    before, after = text.splitlines(), changed.splitlines()
    if "extends" in root:
        assert len(before) == len(after) and sum(a != b for a, b in zip(before, after)) == 1
        assert set_extends(changed, path.name, root["extends"].value) == text
    else:
        after.remove("extends: another.tcf")
        assert after == before


REFUSED = {
    "a list": ("version: 1\nextends: [a.tcf, b.tcf]\n", "robot.tcf:2: 'extends' must be one name"),
    "a map": ("extends: {a: b}\n", "robot.tcf:1: 'extends' must be one name"),
    "no YAML": ("version: 1\nextends: [\n", "robot.tcf:2: this bracket is not closed"),
    "no map": ("- a\n", "robot.tcf:1: this is not a map"),
    "nothing": ("", "robot.tcf:1: this is not a map"),
    "twice": ("extends: a\nextends: b\n", "robot.tcf:2: key 'extends' is set twice"),
}


@pytest.mark.parametrize("what", REFUSED)
def test_a_text_that_needs_an_editor(what: str) -> None:
    text, message = REFUSED[what]
    with pytest.raises(CannotEdit) as problem:
        set_extends(text, "robot.tcf", "c.tcf")
    assert str(problem.value).startswith(message)


def test_docstring() -> None:
    assert doctest.testmod(epg.edit.tcf).failed == 0


LEFT_OUT = {
    "no components yet": (
        "version: 1\nextends: a.tcf  # mine\n# tail\n",
        "version: 1\nextends: a.tcf  # mine\ncomponents:\n  tilt: null\n  guard: {homing: null}\n# tail\n",
    ),
    "other components": (
        "components:\n    pan: {invert: true}   # turned\nnode: x",
        "components:\n    pan: {invert: true}   # turned\n    tilt: null\n    guard: {homing: null}\nnode: x",
    ),
    "both are there": (
        "components:\n  tilt:\n    invert: true\n  guard:\n    stall: null\n    homing: {time: 1 s}\n",
        "components:\n  tilt: null\n  guard:\n    stall: null\n    homing: null\n",
    ),
    "in braces": (
        "{version: 1, components: {guard: {stall: null}}}",
        "{version: 1, components: {guard: {stall: null, homing: null}, tilt: null}}",
    ),
}


@pytest.mark.parametrize("what", LEFT_OUT)
def test_parts_are_left_out(what: str) -> None:
    before, after = LEFT_OUT[what]
    assert leave_out(before, "robot.tcf", [["tilt"], ["guard", "homing"]]) == after
    assert leave_out(after, "robot.tcf", [["tilt"], ["guard", "homing"]]) == after
