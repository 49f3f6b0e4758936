# SPDX-License-Identifier: Apache-2.0
"""Changing the file that a .tcf extends, and leaving out parts of it: all other lines stay."""

from __future__ import annotations

import doctest
from pathlib import Path

import pytest

import epg.edit.tcf
from epg.edit.tcf import JsonValue, remove_value, rename_key, set_value
from epg.edit.yaml_edit import CannotEdit
from epg.generator.diagnostics import Diagnostics
from epg.generator.documents.yaml_file import parse_yaml

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
    "a list": ("version: 1\nextends: [a.tcf, b.tcf]\n", "c.tcf", "version: 1\nextends: c.tcf\n"),
    "the same": ("extends:  'a.tcf'\n", "a.tcf", "extends:  'a.tcf'\n"),
}


@pytest.mark.parametrize("what", EXAMPLES)
def test_only_that_changes(what: str) -> None:
    before, name, after = EXAMPLES[what]
    assert set_value(before, "robot.tcf", ["extends"], name) == after
    assert set_value("\ufeff" + before, "robot.tcf", ["extends"], name) == "\ufeff" + after
    root = parse_yaml(after, "robot.tcf", Diagnostics())
    assert root is not None and root["extends"].value == name


def test_a_key_is_renamed_at_its_place() -> None:
    text = "components:\n  # the lamp\n  light: {kind: x}  # red\n  'on': {kind: y}\n  last: {kind: z}\n"
    changed = rename_key(text, "robot.tcf", ["components", "light"], "lamp")
    assert changed == text.replace("light:", "lamp:")
    assert rename_key(text, "robot.tcf", ["components", "on"], "start") == text.replace("'on'", "'start'")
    with pytest.raises(CannotEdit, match=r"there is no 'components\.dark'"):
        rename_key(text, "robot.tcf", ["components", "dark"], "lamp")


@pytest.mark.parametrize("path", CONFIGURATIONS, ids=lambda path: path.name)
def test_there_and_back(path: Path) -> None:
    text = path.read_text(encoding="utf-8")
    root = parse_yaml(text, path.name, Diagnostics())
    assert root is not None
    changed = set_value(text, path.name, ["extends"], "another.tcf")
    before, after = text.splitlines(), changed.splitlines()
    if "extends" in root:
        assert len(before) == len(after) and sum(a != b for a, b in zip(before, after)) == 1
        assert set_value(changed, path.name, ["extends"], root["extends"].value) == text
    else:
        after.remove("extends: another.tcf")
        assert after == before


REFUSED = {
    "no YAML": ("version: 1\nextends: [\n", "robot.tcf:2: this bracket is not closed"),
    "no map": ("- a\n", "robot.tcf:1: this is not a map"),
    "nothing": ("", "robot.tcf:1: this is not a map"),
    "twice": ("extends: a\nextends: b\n", "robot.tcf:2: key 'extends' is set twice"),
}


@pytest.mark.parametrize("what", REFUSED)
def test_a_text_that_needs_an_editor(what: str) -> None:
    text, message = REFUSED[what]
    with pytest.raises(CannotEdit) as problem:
        set_value(text, "robot.tcf", ["extends"], "c.tcf")
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
    for path in (["tilt"], ["guard", "homing"]):
        before = set_value(before, "robot.tcf", ["components", *path], None)
        after = set_value(after, "robot.tcf", ["components", *path], None)
    assert before == after == LEFT_OUT[what][1]


OWN = """version: 1  # format
target: rpi_pico2_bare_metal
node: me
components:
  # the left one
  motor:
    kind: pwm   # simple
    pins: {value: GP4}
    frequency: 20 kHz  # quiet
  light: {kind: digital_output, pins: {value: GP6}}
"""

SET: dict[str, tuple[list[str], JsonValue, str, str]] = {
    "a quantity": (["components", "motor", "frequency"], "1.5 kHz", "frequency: 20 kHz  #", "frequency: 1.5 kHz  #"),
    "a pin": (["components", "light", "pins", "value"], "GP7", "pins: {value: GP6}}", "pins: {value: GP7}}"),
    "a number for a text": (["components", "motor", "frequency"], 3, "frequency: 20 kHz", "frequency: 3"),
    "a new section in its place": (["control", "period"], "1 ms", "node: me\n", "node: me\ncontrol: {period: 1 ms}\n"),
    "a new parameter": (
        ["components", "motor", "invert"],
        True,
        "frequency: 20 kHz  # quiet\n",
        "frequency: 20 kHz  # quiet\n    invert: true\n",
    ),
    "a map key by key": (
        ["components", "motor"],
        {"kind": "pwm", "pins": {"value": "GP5"}, "max_duty": 0.5},
        "pins: {value: GP4}\n    frequency: 20 kHz  # quiet\n",
        "pins: {value: GP5}\n    max_duty: 0.5\n",
    ),
    "a new component": (
        ["components", "stop"],
        {"kind": "digital_input", "pins": {"value": "GP8"}, "pull": "up"},
        "GP6}}\n",
        "GP6}}\n  stop: {kind: digital_input, pins: {value: GP8}, pull: up}\n",
    ),
    "a long component": (
        ["components", "guard"],
        {"kind": "motion_guard", "actuator": "motor", "encoder": "an_encoder_with_a_name", "stall": {"time": "0.5 s"}},
        "GP6}}\n",
        "GP6}}\n  guard:\n    kind: motion_guard\n    actuator: motor\n    encoder: an_encoder_with_a_name\n"
        "    stall: {time: 0.5 s}\n",
    ),
    "the same": (["components", "light", "kind"], "digital_output", "", ""),
}


@pytest.mark.parametrize("what", SET)
def test_a_value_is_set(what: str) -> None:
    path, value, old, new = SET[what]
    assert OWN.count(old) == 1 or not old
    assert set_value(OWN, "robot.tcf", path, value) == OWN.replace(old, new)


REMOVED = {
    "a parameter": (["components", "motor", "frequency"], "    frequency: 20 kHz  # quiet\n", ""),
    "a map with its last key": (["components", "light", "pins", "value"], ", pins: {value: GP6}", ""),
    "a component": (["components", "light"], "  light: {kind: digital_output, pins: {value: GP6}}\n", ""),
    "no such key": (["control", "period"], "", ""),
}


@pytest.mark.parametrize("what", REMOVED)
def test_a_value_is_removed(what: str) -> None:
    path, old, new = REMOVED[what]
    assert remove_value(OWN, "robot.tcf", path) == OWN.replace(old, new)


def test_the_last_component_is_removed() -> None:
    own = "version: 1\nnode: me\ncomponents:\n  light: {kind: x}  # lamp\n"
    assert remove_value(own, "robot.tcf", ["components", "light"]) == "version: 1\nnode: me\ncomponents: {}\n"
    extending = own.replace("node: me", "extends: host_jiwy.tcf")
    assert remove_value(extending, "robot.tcf", ["components", "light"]) == "version: 1\nextends: host_jiwy.tcf\n"
    assert set_value(extending, "robot.tcf", ["components"], {}) == extending.replace(
        "\n  light: {kind: x}  # lamp", " {}"
    )


@pytest.mark.parametrize("path", CONFIGURATIONS, ids=lambda path: path.name)
def test_each_value_is_set_and_removed(path: Path) -> None:
    text = path.read_text(encoding="utf-8")
    root = parse_yaml(text, path.name, Diagnostics())
    assert root is not None
    for name, node in root["components"].items() if "components" in root else ():
        for key, _ in node.items() if node.is_mapping else ():
            there = ["components", name, key]
            changed = set_value(text, path.name, there, "1 ms")
            after = parse_yaml(changed, path.name, Diagnostics())
            assert after is not None and after["components"][name][key].value == "1 ms"
            if not node[key].is_mapping:
                assert set_value(changed, path.name, there, node[key].plain()) == text
            after = parse_yaml(remove_value(text, path.name, there), path.name, Diagnostics())
            assert after is not None
            left = after.plain().get("components", {})
            assert key not in left.get(name, {})
