# SPDX-License-Identifier: Apache-2.0
"""Edits of bindings files: the changed text, the unchanged text, and refused edits.

``bindings_edits.txt`` has examples, as texts before and after an edit.
"""

from __future__ import annotations

import doctest
from pathlib import Path

import pytest

import epg.edit.bindings
import epg.edit.scalars
from epg.edit.bindings import CannotEdit, WireEnd, ends_of, set_ends
from epg.generator.check.bindings import load_bindings
from epg.generator.diagnostics import Diagnostics
from epg.generator.documents import yaml_file
from epg.generator.documents.yaml_file import parse_yaml
from epg.generator.models.model import Model
from epg.generator.source import YamlNode
from tests.edit.servo import model_of

ROOT = Path(__file__).resolve().parents[2]
SERVO = model_of(("angle", "go", "setpoint"), ("duty", "log", "reset"))
HEAD = "# servo\nversion: 1\nmodel: Servo\n"


def tree(text: str) -> YamlNode:
    problems = Diagnostics()
    root = parse_yaml(text, "servo.bindings.yaml", problems)
    assert root is not None, list(problems)
    return root


def edited(text: str, port: str, ends: tuple[WireEnd, ...] | None, of: Model = SERVO) -> str:
    return set_ends(text, "servo.bindings.yaml", of, port, ends)


def section_of(port: str, model: Model = SERVO) -> str:
    return "inputs" if port in [p.name for p in model.inputs] else "outputs"


def _examples() -> dict[str, tuple[str, tuple[WireEnd, ...] | None, str, str]]:
    """The edit's description, the port, its ends, the file before and after."""
    found = {}
    for part in (Path(__file__).parent / "bindings_edits.txt").read_text(encoding="utf-8").split("=== ")[1:]:
        told, _, texts = part.partition("--- before\n")
        what, line = told.splitlines()
        before, after = texts.removesuffix("\n\n").rstrip("\n").split("--- after\n")
        port = line.partition(":")[0]
        ends = ends_of(tree(f"{section_of(port)}: {{{line}}}"), section_of(port), port)
        found[what] = (port, None if line.endswith(": nothing") else ends, before, after + "\n")
    return found


EXAMPLES = _examples()


@pytest.fixture(params=["libyaml", "PyYAML"])
def parser(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> None:
    """Both parsers that a user may have: in some places their positions differ."""
    import yaml

    if request.param == "PyYAML":
        monkeypatch.setattr(yaml_file, "LOADER", yaml.SafeLoader)
    elif not yaml.__with_libyaml__:
        pytest.skip("PyYAML without libyaml: python -m pip install --force-reinstall pyyaml")


@pytest.mark.usefixtures("parser")
@pytest.mark.parametrize("what", EXAMPLES)
def test_only_that_changes(what: str) -> None:
    port, ends, before, after = EXAMPLES[what]
    assert edited(HEAD + before, port, ends) == HEAD + after
    assert edited(HEAD + after, port, ends) == HEAD + after, "a second time changes nothing"
    for line_end in ("\r\n", "\r"):
        changed = edited("\ufeff" + (HEAD + before).replace("\n", line_end), port, ends)
        assert changed == "\ufeff" + (HEAD + after).replace("\n", line_end)


@pytest.mark.parametrize("what", EXAMPLES)
def test_a_missing_last_line_end_stays_missing(what: str) -> None:
    port, ends, before, after = EXAMPLES[what]
    assert edited((HEAD + before)[:-1], port, ends) == (HEAD + after)[:-1]


TYPED = {
    "a number that is none": (
        WireEnd("a", "1,5", "010", ("yes", "0x10"), "1"),
        "{from: a, scale: '1,5', offset: '010', limits: ['yes', 0x10], unit: '1'}",
    ),
    "a line of its own": (WireEnd("a\ngo: b # c"), r'"a\u000Ago: b # c"'),
    "brackets": (WireEnd("a}, go: {from: b", "[", "]", ("{", "}"), "{%"), None),
    "comments": (WireEnd("a", "# x", "2 # x", ("2#", "-"), "# x"), None),
    "words of YAML": (WireEnd("null", "true", "~", ("null", ""), "no"), None),
    "not a number": (WireEnd("a", ".nan", "nan", ("-.inf", "inf")), None),
    "blanks around": (WireEnd(" a\t", " 2 ", "\n1", ("0 ", " 1"), "rad "), "{from: a, scale: 2, offset: 1, "),
    "other scripts": (WireEnd("größe", "½", "１", ("٣", "1_0"), "µm\u2028\U0001f916\x00"), None),
    "long numbers": (WireEnd("a", "1" * 100, "1e999", ("1:30", "0b1"), "''"), None),
}


@pytest.mark.parametrize("what", TYPED)
def test_what_somebody_types_is_reported_as_from_a_file(what: str, tmp_path: Path) -> None:
    end, written = TYPED[what]
    text = edited(HEAD + "inputs: {angle: x, go: y}\noutputs: {}\n", "angle", (end,))
    assert written is None or written in text
    assert tree(text)["inputs"].plain().keys() == {"angle", "go"}
    file = tmp_path / "servo.bindings.yaml"
    file.write_text(text, encoding="utf-8")
    problems = Diagnostics()
    load_bindings(file, problems)
    assert problems.has_errors != (what == "blanks around")
    assert {problem.span.line for problem in problems} <= {4}
    assert "yaml" not in " ".join(problem.id for problem in problems)
    text = edited(text, "angle", (WireEnd("a", "1/4", "1", ("0", "1"), "rad"),))
    assert tree(text)["inputs"].plain()["angle"] == {
        "from": "a",
        "scale": "1/4",
        "offset": 1,
        "limits": [0, 1],
        "unit": "rad",
    }


REFUSED: dict[str, tuple[str, str, tuple[WireEnd, ...] | None, str]] = {
    "no such port": ("inputs: {}\n", "angel", (WireEnd("a"),), "servo.bindings.yaml: Servo has no port 'angel'"),
    "an input of nothing": ("", "angle", (), "servo.bindings.yaml: input 'angle' must be bound to one component"),
    "an input of two": (
        "",
        "angle",
        (WireEnd("a"), WireEnd("b")),
        "servo.bindings.yaml: input 'angle' must be bound to one component",
    ),
    "to be unconnected": (
        "",
        "log",
        (WireEnd("unconnected"),),
        "servo.bindings.yaml: 'unconnected' is not a component",
    ),
    "a section that is none": (
        "inputs: [a]\n",
        "angle",
        (WireEnd("a"),),
        "servo.bindings.yaml:4: 'inputs' is not a map",
    ),
    "a mistake": ("inputs: {\n", "angle", (WireEnd("a"),), "servo.bindings.yaml:4: this bracket is not closed"),
    "an anchor": ("inputs: {angle: &a b}\n", "angle", (WireEnd("a"),), "servo.bindings.yaml:4: anchors and aliases"),
    "no character": ("", "angle", (WireEnd("\ud800"),), "servo.bindings.yaml: a name or value for 'inputs' is not"),
    "a key too long for YAML": ("outputs: {}\n", "x" * 1100, (WireEnd("a"),), "servo.bindings.yaml:4: 'xxx"),
}


@pytest.mark.parametrize("what", REFUSED)
def test_a_change_that_needs_an_editor(what: str) -> None:
    text, port, ends, message = REFUSED[what]
    model = model_of(("angle",), ("log", "x" * 1100))
    with pytest.raises(CannotEdit) as problem:
        edited(HEAD + text, port, ends, model)
    assert str(problem.value).startswith(message)


def test_a_port_that_the_model_has_no_more_can_be_taken_out() -> None:
    text = HEAD + "inputs:\n  gone: a\n  duty: b   # an output\n"
    assert edited(text, "gone", None) == HEAD + "inputs:\n  duty: b   # an output\n"
    assert edited(edited(text, "gone", None), "duty", None) == HEAD + "inputs: {}\n"
    with pytest.raises(CannotEdit):
        edited(text, "gone", (WireEnd("a"),))


def test_ends_of() -> None:
    root = tree(
        "inputs:\n  a: {from: x.y, scale: 1/4, offset: 0.50, limits: [-1, 1e3], unit: rad}\n  b: unconnected\n"
        "outputs:\n  c: unconnected\n  d: [x, {to: y, scale: 2}]\n"
    )
    assert ends_of(root, "inputs", "a") == (WireEnd("x.y", "1/4", "0.5", ("-1", "1000.0"), "rad"),)
    assert ends_of(root, "inputs", "b") == (WireEnd("unconnected"),), "only outputs can be unconnected"
    assert ends_of(root, "outputs", "c") == ()
    assert ends_of(root, "outputs", "d") == (WireEnd("x"), WireEnd("y", "2"))
    assert ends_of(root, "outputs", "a") is None


FILES = sorted(ROOT.glob("examples/**/*bindings.yaml"))


@pytest.mark.parametrize("path", FILES, ids=lambda path: f"{path.parent.name}/{path.name}")
def test_files_of_the_examples(path: Path) -> None:
    """Every port is connected otherwise and restored, and removed and restored: the file is the same."""
    text = path.read_bytes().decode()
    root = tree(text)
    names = {section: [key for key, _ in root[section].items()] for section in ("inputs", "outputs") if section in root}
    model = model_of(names.get("inputs", ()), names.get("outputs", ()))
    for section, ports in names.items():
        for port in ports:
            old = ends_of(root, section, port)
            assert old is not None
            for new in ((WireEnd("other", scale="-1/3", limits=("0", "1")),), (WireEnd("other.port"),)):
                changed = edited(text, port, new, model)
                assert ends_of(tree(changed), section, port) == new
                assert sum(a != b for a, b in zip(text.splitlines(), changed.splitlines())) == 1
                assert edited(changed, port, old, model) == text
            without = edited(text, port, None, model)
            assert tree(without).plain() | {section: {}} == root.plain() | {section: {}}
            assert [key for key, _ in tree(without)[section].items()] == [name for name in ports if name != port]
            put_back = edited(without, port, old, model)
            assert put_back == text or "#" in text.split(section)[1] or len(ports) == 1
            assert tree(put_back).plain() == root.plain()


def test_all_examples_were_found() -> None:
    assert len(FILES) >= 9


def test_docstrings() -> None:
    assert doctest.testmod(epg.edit.scalars).failed == 0
    globs = {**vars(epg.edit.bindings), "model": model_of(("angle",), ())}
    assert doctest.testmod(epg.edit.bindings, extraglobs=globs).failed == 0
