# SPDX-License-Identifier: Apache-2.0
"""Edits of random bindings files: the requested change is made; no other meaning and no other text changes."""

from __future__ import annotations

import re

import pytest
from hypothesis import event, given, note, settings
from hypothesis import strategies as st

from epg.edit.applied import apply_edit, edits_of
from epg.edit.bindings import CannotEdit, WireEnd, ends_of, set_ends
from epg.edit.ends import data_of
from epg.edit.scalars import scalar_text
from epg.generator.correction import KeyValue
from epg.generator.diagnostics import LINE_BREAK, Diagnostic, Diagnostics
from epg.generator.documents.yaml_file import parse_yaml
from epg.generator.source import Span, YamlNode
from tests.edit.bindings_texts import PORTS, Text, bindings_texts, ends
from tests.edit.servo import model_of
from tests.fuzz.long_run import PROFILE, examples

MODEL = model_of(PORTS["inputs"], PORTS["outputs"])


def _edits() -> st.SearchStrategy[tuple[str, str, tuple[WireEnd, ...] | None]]:
    inputs = st.tuples(st.just("inputs"), st.sampled_from(PORTS["inputs"]), st.none() | ends.map(lambda end: (end,)))
    several = st.lists(ends, max_size=3, unique_by=lambda end: end.reference).map(tuple)
    outputs = st.tuples(st.just("outputs"), st.sampled_from(PORTS["outputs"]), st.none() | several)
    return inputs | outputs


edits = _edits()


def _root(text: str) -> YamlNode:
    problems = Diagnostics()
    root = parse_yaml(text.removeprefix("\ufeff"), "servo.bindings.yaml", problems)
    assert root is not None, (list(problems), text)
    return root


def _data(section: str, said: tuple[WireEnd, ...] | None) -> object:
    return None if said is None else [data_of(end, section) for end in said]


def _set(text: str, port: str, said: tuple[WireEnd, ...] | None) -> str:
    changed = set_ends(text, "servo.bindings.yaml", MODEL, port, said)
    note(f"--- {port} -> {said}\n{changed}")
    return changed


def _comments(text: str) -> list[str]:
    return re.findall(r"#\d+", text)


def _own_comments(file: Text, names: set[str]) -> set[str]:
    return {word for line in file.lines if line.owner in names for word in _comments(line.text)}


@settings(PROFILE, max_examples=examples(120))
@given(bindings_texts(), st.lists(edits, min_size=1, max_size=5))
def test_what_is_wanted_is_said_and_comments_stay(
    file: Text, told: list[tuple[str, str, tuple[WireEnd, ...] | None]]
) -> None:
    text = before = file.text
    note(before)
    wanted = {section: dict(ports) for section, ports in file.said.items()}
    edited: set[str] = set()
    for section, port, said in told:
        text = _set(text, port, said)
        edited.add(port)
        if file.said[section].get(port) is None and section in file.in_braces:
            edited.add(section)
        if said is None:
            wanted[section].pop(port, None)
        else:
            wanted[section][port] = said
    root = _root(text)
    for section, ports in PORTS.items():
        for port in ports:
            assert repr(_data(section, ends_of(root, section, port))) == repr(_data(section, wanted[section].get(port)))
        node = root.get(section)
        assert node is None or node.is_mapping
    for key in ("version", "model", "parameters"):
        old, new = _root(before).get(key), root.get(key)
        assert (old and old.plain()) == (new and new.plain())
    for _, port, said in told:
        if said is not None and port in file.open:
            assert f"# {scalar_text(port)}:    # no name matches" not in text
    # in braces, a comment is on the line of a port, but the text does not show to which port it belongs
    may_go = _own_comments(file, edited | (file.in_braces & {section for section, _, _ in told}))
    kept = [comment for comment in _comments(text) if comment not in may_go]
    assert kept == [comment for comment in _comments(before) if comment not in may_go]
    assert len(set(_comments(text))) == len(_comments(text))
    assert text.count("\r") == (text.count("\n") if file.line_end == "\r\n" else 0)
    if file.has_last_end:
        assert text.endswith("\n")


@settings(PROFILE, max_examples=examples(120))
@given(bindings_texts(), edits)
def test_lines_of_others_are_untouched(file: Text, edit: tuple[str, str, tuple[WireEnd, ...] | None]) -> None:
    section, port, said = edit
    note(file.text)
    after = _set(file.text, port, said).split(file.line_end)
    if file.has_last_end:
        after.pop()
    # the section's name changes if the section gets its first port or loses its last one, or is in braces
    ports = file.said[section]
    may_change = {port, section} if section in file.in_braces or not set(ports) - {port} else {port}
    rest = iter(after)
    for line in file.lines:
        assert line.owner in may_change or line.text in rest


@settings(PROFILE, max_examples=examples(120))
@given(bindings_texts(), st.data())
def test_there_and_back(file: Text, data: st.DataObject) -> None:
    note(file.text)
    # new ports in existing sections, and ports whose value is one word
    added = [
        (section, port)
        for section, said in file.said.items()
        for port in PORTS[section]
        if said and port not in said and port not in file.open
    ]
    words = re.compile(r"""\s*('.*'|".*"|\S*) ?: ['"]?[a-z_.]+['"]?\s*(#.*)?""")
    lines = {line.owner: line.text for line in file.lines if words.fullmatch(line.text)}
    changed = [
        (section, port)
        for section, said in file.said.items()
        for port, old in said.items()
        if port in lines and sum(line.owner == port for line in file.lines) == 1 and "unconnected'" not in lines[port]
    ]
    if not added and not changed:
        event("nothing to do")
        return
    section, port = data.draw(st.sampled_from(added + changed))
    new = tuple(
        data.draw(st.lists(ends, min_size=1, max_size=2 if section == "outputs" and (section, port) in added else 1))
    )
    old = file.said[section].get(port)
    assert _set(_set(file.text, port, new), port, old) == file.text
    event("changed" if old is not None else "added")


@settings(PROFILE, max_examples=examples(120))
@given(bindings_texts(), st.data())
def test_an_edit_that_binds_a_port(file: Text, data: st.DataObject) -> None:
    """The edit of a hint for a port that is not bound is what the page does when it connects the port."""
    text = file.text.removeprefix("\ufeff")
    note(text)
    missing = [(section, port) for section, said in file.said.items() for port in PORTS[section] if port not in said]
    if not missing:
        event("nothing to do")
        return
    section, port = data.draw(st.sampled_from(missing))
    hint = KeyValue("write it", "servo.bindings.yaml", (section, port), "encoder.reset", PORTS[section])
    message = Diagnostic("unbound-input", "error", Span("servo.bindings.yaml", 1), "m", hint, about=port)
    (edit,) = edits_of(message, lambda name: text if name == "servo.bindings.yaml" else None)
    note(repr(edit))
    after = apply_edit(text, edit)
    assert after == set_ends(text, "servo.bindings.yaml", MODEL, port, (WireEnd("encoder.reset"),))
    lines, end = LINE_BREAK.split(text), edit.end
    assert len(lines[end[0] - 1]) >= end[1] - 1, "the place is in the text"
    if edit.old == "":
        event("insertion")
        before = lines[edit.span.line - 1][: edit.span.column - 1]
        is_line = LINE_BREAK.match(edit.new) and before == lines[edit.span.line - 1]
        assert is_line or section in file.in_braces or {"{", "["} & set(before)
    assert edits_of(message, lambda name: None) == []


anything = st.text(st.characters(exclude_categories=()), min_size=1, max_size=12) | st.text(
    "ab.:#'\"{}[],&*!|>%@`\\ \n\r\t\x85\u2028-?~0é\U0001f916", min_size=1, max_size=8
)


@settings(PROFILE, max_examples=examples(120))
@given(
    st.lists(anything, min_size=1, max_size=3, unique=True),
    anything,
    anything,
    st.sampled_from(["outputs: {x: y}   # c\n", "outputs:\n  x: y   # c\n", "outputs:\n  x:\n    - y   # c\n", ""]),
)
def test_names_of_any_kind(names: list[str], reference: str, typed: str, rest: str) -> None:
    names = [name for name in names if name != "x"]
    model = model_of((), (*names, "x"))
    text = before = "version: 1\nmodel: Servo\n" + rest
    end = WireEnd(reference, typed, typed, (typed, "1"), typed)
    there = []
    for name in names:
        note(text)
        try:
            text = set_ends(text, "servo.bindings.yaml", model, name, (end, WireEnd("z")))
        except CannotEdit:
            # only characters that YAML cannot represent
            assert any("\ud800" <= character <= "\udfff" for character in name + reference + typed)
            event("cannot be written")
            continue
        there.append(name)
    note(text)
    text.encode()
    root = _root(text)
    section = root.get("outputs")
    assert {key for key, _ in root.items()} <= {"version", "model", "outputs"}
    assert {key for key, _ in (section.items() if section else ())} == {*there, *(["x"] if rest else [])}
    assert not rest or text.count("# c\n") == 1
    for name in reversed(there):
        said = ends_of(root, "outputs", name)
        assert said is not None and said[0].reference == reference.strip()
        text = set_ends(text, "servo.bindings.yaml", model, name, None)
    assert text == (before if rest or not there else before + "outputs: {}\n")


@pytest.mark.parametrize("section", PORTS)
def test_what_was_never_there_is_not_missed(section: str) -> None:
    text = "version: 1\nmodel: Servo\n"
    for port in PORTS[section]:
        assert set_ends(text, "servo.bindings.yaml", MODEL, port, None) == text
