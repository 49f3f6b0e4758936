# SPDX-License-Identifier: Apache-2.0
"""Every message of EPG, to the letter.

A file ``cases/<name>.case``, here or of the tests in ``integration``, has the wrong files and EPG's messages about
them::

    $ epg check --tcf robot.tcf --model model --bindings bindings.yaml
    --- robot.tcf
    version: 1
    ...
    --- expected
    robot.tcf:3:1: error: ...

Files that a case does not mention are those of ``common/``; the command is the one above unless the first line gives
another.  After ``--- name <- edit`` come changes to the common file, one ``old => new`` per line, where ``\\n`` is a
line end.  ``--- name <- copy PATH`` is a folder of the repository under another name, ``--- name <- python`` the
bytes that an expression gives.  A file that begins with ``#!`` can be executed.  No boards are attached.  A folder
``targets`` is in ``EPG_TARGETS_PATH``.  The command may have quotes, and begin with variables of the environment, as in
a shell.

Where messages propose edits, ``--- meant`` states what the author of the wrong file meant: each changed or new line
after the edits, or the argument of the command::

    --- meant
    robot.tcf:5: control: {period: 1 ms}

The test makes all edits and compares the lines, and then runs the command again: the messages with an edit must be
gone.  Of edits at the same place it makes the first, and then those that are proposed next.  A message that is new in a
changed line needs a line ``and then: MESSAGE [ID]``: that the author meant this, although it is wrong for another
reason.  If a message proposes several edits, each is made alone, and its lines begin with ``or: ``.  At its end the
test prints the share of messages with an edit.
``EPG_UPDATE_GOLDEN=1`` rewrites the expected messages, but never what is meant: review the difference.
"""

from __future__ import annotations

import difflib
import json
import os
import re
import shlex
import shutil
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import pytest

from epg.cli import report
from epg.cli.main import main
from epg.edit.applied import apply_edit
from epg.generator.catalog.catalog import Catalog
from epg.generator.data import targets_roots
from epg.generator.diagnostics import LINE_BREAK, Diagnostic, Diagnostics, Edit
from epg.generator.documents.yaml_file import parse_yaml
from epg.generator.emit.cmake import PathNames
from epg.generator.emit.outputs import application_outputs
from epg.generator.source import Span
from epg.generator.tools import usb_boards
from epg.system.check_system import check_system
from epg.system.load_system import load_system

HERE = Path(__file__).resolve().parent
CASES = sorted([*(HERE / "cases").glob("*.case"), *HERE.parents[1].glob("integration/*/tests/cases/*.case")])
COMMAND = "epg check --tcf robot.tcf --model model --bindings bindings.yaml"


def read_case(path: Path) -> tuple[str, dict[str, str], str]:
    """Command, files and expected messages of a case."""
    text = path.read_text(encoding="utf-8")
    command = COMMAND
    if text.startswith("$ "):
        first, _, text = text.partition("\n")
        command = first.removeprefix("$ ")
    parts = re.split(r"^--- (.+)\n", text, flags=re.MULTILINE)
    files = dict(zip(parts[1::2], parts[2::2]))
    files.pop("meant", None)
    return command, files, files.pop("expected", "")


def read_meant(path: Path) -> str:
    """What the author of the files of a case meant; empty if no message proposes an edit."""
    found = re.search(r"^--- meant\n(.*?)^--- ", path.read_text(encoding="utf-8"), re.MULTILINE | re.DOTALL)
    return found[1] if found else ""


def lay_out(folder: Path, files: dict[str, str]) -> None:
    """Writes the common files, and then those of the case."""
    shutil.copytree(HERE / "common", folder, dirs_exist_ok=True)
    for name, text in files.items():
        copied, _, origin = name.partition(" <- copy ")
        if origin:
            shutil.copytree(HERE.parent.parent / origin, folder / copied, dirs_exist_ok=True)
            continue
        if name.endswith(" <- python"):
            path = folder / name.removesuffix(" <- python")
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_bytes(eval(text))
            continue
        edited = name.removesuffix(" <- edit")
        path = folder / edited
        path.parent.mkdir(parents=True, exist_ok=True)
        if edited != name:
            source = path.read_text(encoding="utf-8")
            for line in text.splitlines():
                old, _, new = line.partition(" => ")
                old = old.replace("\\n", "\n")
                assert old in source, f"{old!r} is not in {path.name}"
                source = source.replace(old, new.replace("\\n", "\n"), 1)
            text = source
        path.write_text(text, encoding="utf-8")
        if text.startswith("#!"):
            path.chmod(0o755)


def image(system: Path, target: str) -> bytes:
    """A program of a target, as far as EPG reads it: the hash of the target."""
    diagnostics = Diagnostics()
    checked = check_system(diagnostics.checked(load_system(system, diagnostics)), (), diagnostics)
    assert checked is not None
    files = application_outputs(checked.applications[target], checked.loader.roots, PathNames(None))
    return json.loads(files[f"{target}.json"])["hash"].encode()


@pytest.fixture(scope="module")
def counted(request: pytest.FixtureRequest) -> Iterator[dict[str, int]]:
    """Counts messages, those with an edit, and edits that were made and gave what was meant."""
    numbers = {"messages": 0, "edits": 0, "meant": 0}
    yield numbers
    messages, edits, meant = numbers.values()
    plugins: Any = request.config.pluginmanager
    terminal, capture = plugins.getplugin("terminalreporter"), plugins.getplugin("capturemanager")
    if edits and terminal is not None and capture is not None:
        share, right = f"{100 * edits / messages:.0f} %", f"{100 * meant / edits:.0f} %"
        with capture.global_and_fixture_disabled():
            terminal.write_line(
                f"\n{edits} of {messages} messages ({share}) propose an edit; {meant} ({right}) gave what was meant"
            )


@pytest.fixture(autouse=True)
def read_once(monkeypatch: pytest.MonkeyPatch, items: dict[tuple[str, str], tuple[Any, set[Path]]]) -> None:
    """Reads each of EPG's own boards, platforms and kinds once for all cases, as one program does for all its files.

    A case with a folder ``targets`` reads all of them again, because its files can be parts of EPG's own items.
    """
    load = Catalog._load

    def load_once(self: Catalog, category: str, name: str, make: Any) -> Any:
        if self.roots != targets_roots():
            return load(self, category, name, make)
        if (category, name) not in items:
            before, self.files = self.files, set()
            items[category, name] = load(self, category, name, make), self.files
            self.files = before
        item, files = items[category, name]
        self.files |= files
        return item

    monkeypatch.setattr(Catalog, "_load", load_once)


@pytest.fixture(scope="module")
def items() -> dict[tuple[str, str], tuple[Any, set[Path]]]:
    """The items of EPG's own catalog that cases have read, each with its files."""
    return {}


@pytest.fixture
def reported(monkeypatch: pytest.MonkeyPatch) -> list[Diagnostic]:
    """The diagnostics of the last command, which prints them as always."""
    last: list[Diagnostic] = []
    print_them = report.format_diagnostics

    def keep(diagnostics: Diagnostics) -> str:
        last[:] = diagnostics
        return print_them(diagnostics)

    monkeypatch.setattr(report, "format_diagnostics", keep)
    return last


@pytest.mark.parametrize("case", CASES, ids=lambda path: path.stem)
def test_message(
    case: Path,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capfd: pytest.CaptureFixture[str],
    reported: list[Diagnostic],
    counted: dict[str, int],
) -> None:
    command, files, expected = read_case(case)
    lay_out(tmp_path, files)
    monkeypatch.chdir(tmp_path)
    monkeypatch.delenv("EPG_TARGETS_PATH", raising=False)
    monkeypatch.setattr(usb_boards, "DEVICES", tmp_path / "no devices")
    if (tmp_path / "targets").is_dir():
        monkeypatch.setenv("EPG_TARGETS_PATH", "targets")
    variables, _, arguments = f" {command}".partition(" epg ")
    for variable in variables.split():
        monkeypatch.setenv(*variable.split("=", 1))
    status = main(shlex.split(arguments))
    output = capfd.readouterr()
    assert "Traceback" not in output.err
    if os.environ.get("EPG_UPDATE_GOLDEN"):
        text = case.read_text(encoding="utf-8")
        head = re.split(r"^--- expected\n", text, flags=re.MULTILINE)[0]
        case.write_text(f"{head}--- expected\n{output.err}", encoding="utf-8")
        expected = output.err
    assert output.err.replace(os.sep, "/") == expected.replace(os.sep, "/")
    assert status == (1 if ": error: " in expected else 0)
    assert re.search(r": (error|warning|note): .* \[[a-z0-9.-]+\]$", expected, re.MULTILINE)

    ordered = sorted(reported, key=lambda d: (d.span.file, d.span.line, d.span.column, d.id, d.message))
    proposed = [(each, edits) for each, edits in zip(ordered, report.edits_of(ordered)) if edits]
    counted["messages"] += len(ordered)
    counted["edits"] += len(proposed)
    for each, edits in proposed:
        for edit in edits:
            assert edit.sentence in each.hint and edit.new != edit.old, "the command line has the sentence, too"

    def lines_after(edits: list[tuple[Diagnostic, Edit]]) -> list[str]:
        """The lines that ``edits`` change, and the new messages about them.  The files are restored."""
        before = {path: path.read_bytes() for path in {Path(edit.span.file) for _, edit in edits} if path.is_file()}
        now, wanted, arguments_after = arguments, {key_of(each) for each, _ in edits}, set()
        known = {key_of(each) for each in ordered} - wanted
        while edits:
            chosen = {edit.span: (each, edit) for each, edit in reversed(edits)}
            now = make_edits([edit for _, edit in chosen.values()], now)
            arguments_after |= {place_of(e.span, e) for _, e in edits if e.span.text is not None}
            assert main(shlex.split(now)) in (0, 1)
            assert "Traceback" not in capfd.readouterr().err
            wanted -= {key_of(each) for each, _ in chosen.values()}
            edits = [
                (d, e) for d, found in zip(reported, report.edits_of(reported)) for e in found if key_of(d) in wanted
            ]
        places = {place for path, text in before.items() for place in changed_lines(path, text)}
        lines = [f"{file}: {text}" for file, _, text in sorted(arguments_after)]
        lines += [f"{file}:{number}: {line}" for file, number, line in sorted(places)]
        changed = {(file, number, "") for file, number, _ in places} | arguments_after
        new = [each for each in reported if key_of(each) not in known and place_of(each.span) in changed]
        for path, text in before.items():
            path.write_bytes(text)
        return lines + sorted(f"and then: {each.message} [{each.id}]" for each in new)

    lines = lines_after([(each, edits[0]) for each, edits in proposed if len(edits) == 1])
    for each, edits in proposed:
        lines += [f"or: {line}" for edit in edits for line in lines_after([(each, edit)]) if len(edits) > 1]
    assert "".join(f"{line}\n" for line in lines).replace(os.sep, "/") == read_meant(case).replace(os.sep, "/")
    counted["meant"] += len(proposed)


def key_of(diagnostic: Diagnostic) -> tuple[str, str]:
    """A message, wherever it is."""
    return diagnostic.id, diagnostic.message


def make_edits(edits: Sequence[Edit], arguments: str) -> str:
    """The arguments of the command after ``edits``, which are made in files, too.

    The last edit of a file is made first, so that it does not move the others.
    """
    for edit in sorted(edits, key=lambda edit: (edit.span.line, edit.span.column), reverse=True):
        if edit.span.text is not None and edit.span.file == "command line":
            assert edit.span.text in arguments
            arguments = arguments.replace(edit.span.text, edit.within(edit.span.text), 1)
            continue
        path = Path(edit.span.file)
        text = path.read_bytes().decode("utf-8")
        after = apply_edit(text, edit)
        assert after is not None and components_of(after) >= components_of(text), "no edit removes a component"
        path.write_bytes(after.encode("utf-8"))
    return arguments


def changed_lines(path: Path, before: bytes) -> list[tuple[str, int, str]]:
    """The lines of a file that are not as they were ``before``: the file, the number, and the text."""
    old, new = (LINE_BREAK.split(text.decode("utf-8")) for text in (before, path.read_bytes()))
    steps = difflib.SequenceMatcher(None, old, new, autojunk=False).get_opcodes()
    return [(str(path), i + 1, new[i]) for step, _, _, i1, i2 in steps if step != "equal" for i in range(i1, i2)]


def place_of(span: Span, edit: Edit | None = None) -> tuple[str, int, str]:
    """The line of a position, or the argument, after an ``edit`` of it."""
    return span.file, span.line, (edit.within(span.text) if edit is not None else span.text) if span.text else ""


def components_of(text: str) -> set[str]:
    """The names of the components in the text of a file; empty if it is not YAML with components."""
    root = parse_yaml(text, "", Diagnostics())
    section = root.get("components") if root is not None else None
    return {name for name, _ in section.items()} if section is not None else set()


def test_every_kind_of_message_has_a_case() -> None:
    """The ids in EPG's sources are those in the cases (simulations, runs and plug-ins have their own tests)."""
    root = HERE.parent.parent / "epg"
    ids = set()
    for path in root.rglob("*.py"):
        if {"simulate", "runs", "plugins.py"} & {*path.parts}:
            continue
        ids |= set(
            re.findall(
                r"""(?:error|warning|note)\(\s*["']([a-z0-9.]+(?:-[a-z0-9.]+)+)["']""", path.read_text(encoding="utf-8")
            )
        )
    shown = {
        found
        for case in CASES
        for found in re.findall(r"\[([a-z0-9.-]+)\]$", case.read_text(encoding="utf-8"), re.MULTILINE)
    }
    assert sorted(ids - shown) == []
