# SPDX-License-Identifier: Apache-2.0
"""``epg migrate``.  No format has changed so far, so the migrations here exist in these tests only."""

from __future__ import annotations

import json
import os
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import pytest

from epg.check.schema import load_schema
from epg.cli.main import main
from epg.load import migrate as module
from epg.load.migrate import FORMATS, Edit, apply_edits, format_of, rename_key, replace_value
from epg.source import Node, Span

ROOT = Path(__file__).resolve().parent.parent.parent


def first(root: Node) -> Iterator[Edit]:
    """From 1 to 2: ``control.period`` was called ``step``, and written in seconds without a unit."""
    control = root.get("control")
    if control is not None and "step" in control:
        yield from rename_key(control, "step", "period")
        yield from replace_value(control["step"], f"{control['step'].value} s")


def second(root: Node) -> Iterator[Edit]:
    """From 2 to 3: every ``kind: encoder`` is called ``quadrature_encoder``."""
    for _, component in root["components"].items():
        if component["kind"].value == "encoder":
            yield from replace_value(component["kind"], "quadrature_encoder")


@pytest.fixture
def changed_format(monkeypatch: pytest.MonkeyPatch) -> None:
    """A ``.tcf`` of version 3, with the two migrations that lead there."""
    monkeypatch.setitem(FORMATS, "tcf", replace(FORMATS["tcf"], newest=3, migrations={1: first, 2: second}))


OLD = """\
# mine
version: 1   # of the format
node: "n\u00f6de"
control: {step: 0.001,   enable_at_start: true}  # step: 0.001
components:

  # the load
  left:  {kind: encoder, note: "\U0001f916 kind: encoder"}   # kind: encoder
  right:
    kind: 'encoder'
    pins: {a: 1,
           b: 2}
  motor: {kind: pwm}
"""
NEW = """\
# mine
version: 3   # of the format
node: "n\u00f6de"
control: {period: 0.001 s,   enable_at_start: true}  # step: 0.001
components:

  # the load
  left:  {kind: quadrature_encoder, note: "\U0001f916 kind: encoder"}   # kind: encoder
  right:
    kind: quadrature_encoder
    pins: {a: 1,
           b: 2}
  motor: {kind: pwm}
"""


@pytest.mark.usefixtures("changed_format")
@pytest.mark.parametrize("end", ["\n", "\r\n", "\r"])
@pytest.mark.parametrize("mark", [b"", b"\xef\xbb\xbf"])
def test_an_old_file_becomes_new_and_keeps_the_rest(
    end: str, mark: bytes, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "robot.tcf"
    file.write_bytes(mark + OLD.replace("\n", end).encode())
    assert main(["migrate", str(file)]) == 0
    assert file.read_bytes() == mark + NEW.replace("\n", end).encode()
    assert capsys.readouterr().out == f"{file}: version 1 is now 3\n"
    assert list(tmp_path.iterdir()) == [file]


@pytest.mark.usefixtures("changed_format")
def test_a_file_in_between(tmp_path: Path) -> None:
    file = tmp_path / "robot.tcf"
    file.write_text("version: 2\ncontrol: {step: 1}\ncomponents: {left: {kind: encoder}}\n")
    assert main(["migrate", str(file)]) == 0
    assert file.read_text() == "version: 3\ncontrol: {step: 1}\ncomponents: {left: {kind: quadrature_encoder}}\n"


@pytest.mark.usefixtures("changed_format")
def test_nothing_is_written_when_nothing_changes(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "robot.tcf"
    file.write_text(NEW, encoding="utf-8")
    os.utime(file, ns=(1, 1))
    assert main(["migrate", str(file)]) == 0
    assert file.stat().st_mtime_ns == 1
    assert capsys.readouterr().out == f"{file}: version 3, the newest\n"


@pytest.mark.usefixtures("changed_format")
def test_check_writes_nothing(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "robot.tcf"
    file.write_text(OLD, encoding="utf-8")
    assert main(["migrate", "--check", str(file)]) == 1
    assert file.read_text(encoding="utf-8") == OLD
    assert capsys.readouterr().out == f"{file}: version 1 would become 3\n"
    main(["migrate", str(file)])
    assert main(["migrate", "--check", str(file)]) == 0


@pytest.mark.usefixtures("changed_format")
def test_as_json(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "robot.tcf"
    file.write_text(OLD, encoding="utf-8")
    assert main(["migrate", "--json", str(file)]) == 0
    entry = {"file": str(file), "format": "tcf", "from": 1, "to": 3}
    assert json.loads(capsys.readouterr().out) == {"files": [entry]}


@pytest.mark.usefixtures("changed_format")
def test_links_and_permissions_stay(tmp_path: Path) -> None:
    (tmp_path / "real").mkdir()
    real, link = tmp_path / "real/robot.tcf", tmp_path / "robot.tcf"
    real.write_text(OLD, encoding="utf-8")
    real.chmod(0o640)
    link.symlink_to(real)
    assert main(["migrate", str(link)]) == 0
    assert link.is_symlink()
    assert real.read_text(encoding="utf-8") == NEW
    assert real.stat().st_mode & 0o777 == 0o640


@pytest.mark.usefixtures("changed_format")
def test_wrong_files_are_left_alone_and_the_others_migrated(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    texts = {
        "newer.tcf": "version: 4\n",
        "broken.tcf": "version: [\n",
        "none.tcf": "node: x\n",
        "odd.tcf": "version: a\n",
    }
    texts |= {"ancient.tcf": "version: 0\n", "notes.yaml": "a: 1\n"}
    for name, text in texts.items():
        (tmp_path / name).write_text(text)
    (tmp_path / "robot.tcf").write_text(OLD, encoding="utf-8")
    files = [str(tmp_path / name) for name in (*texts, "missing.tcf", "robot.tcf")]
    assert main(["migrate", *files]) == 1
    errors = capsys.readouterr().err
    for message in (
        "newer.tcf:1:10: error: file format 4 is newer than this EPG, which reads up to 3 [newer-version]",
        "[yaml-syntax]",
        "none.tcf:1:1: error: 'version' is missing [missing-key]",
        "odd.tcf:1:10: error: expected a whole number, found 'a' [wrong-type]",
        "ancient.tcf:1:10: error: there is no file format 0: the oldest is 1 [wrong-value]",
        "notes.yaml:1:1: error: this is no file of EPG's [unknown-file]",
        "[file-not-found]",
    ):
        assert message in errors
    assert {name: (tmp_path / name).read_text() for name in texts} == texts
    assert (tmp_path / "robot.tcf").read_text(encoding="utf-8") == NEW


def test_a_migration_that_breaks_a_file_is_a_bug_and_writes_nothing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    broken = replace(FORMATS["tcf"], newest=2, migrations={1: lambda root: [Edit(Span("", 2, 1, 2), "}")]})
    monkeypatch.setitem(FORMATS, "tcf", broken)
    file = tmp_path / "robot.tcf"
    file.write_text("version: 1\nnode: x\n")
    assert main(["migrate", str(file)]) == 3
    assert "this is a bug in EPG" in capsys.readouterr().err
    assert file.read_text() == "version: 1\nnode: x\n"


def test_edits_must_not_overlap() -> None:
    assert apply_edits("ab\ncd", [Edit(Span("", 2, 1, 2), "x"), Edit(Span("", 1, 2, 3), "y")]) == "ay\nxd"
    with pytest.raises(ValueError, match="overlap"):
        apply_edits("abcd", [Edit(Span("", 1, 1, 4), "x"), Edit(Span("", 1, 3, 4), "y")])


@pytest.mark.parametrize(
    ("name", "keys", "format"),
    [
        ("a.tcf", (), "tcf"),
        ("model.yaml", (), "model"),
        ("board.yaml", (), "board"),
        ("component.yaml", (), "component"),
        ("jiwy.bindings.yaml", ("model", "inputs"), "bindings"),
        ("bindings.yaml", (), "bindings"),
        ("tracking.yaml", ("setpoints", "axes"), "scenario"),
        ("notes.yaml", ("a",), None),
    ],
)
def test_formats_are_told_apart(name: str, keys: tuple[str, ...], format: str | None) -> None:
    node = Node({key: Node(1, Span(name)) for key in keys}, Span(name))
    found = format_of(Path(name), node)
    assert (found.name if found else None) == format


@pytest.mark.parametrize("format", FORMATS.values(), ids=lambda format: format.name)
def test_versions_are_those_of_the_schemas(format: module.Format) -> None:
    assert load_schema(format.name)["properties"][format.key]["const"] == format.newest
    assert sorted(format.migrations) == list(range(format.oldest, format.newest))


def test_all_files_of_this_repository_are_new(capsys: pytest.CaptureFixture[str]) -> None:
    files = [*ROOT.glob("targets/*/*/*.yaml"), *ROOT.glob("targets/robots/*/*.tcf"), *ROOT.glob("examples/*/*.yaml")]
    assert len(files) > 30
    assert main(["migrate", "--check", *map(str, files)]) == 0, capsys.readouterr().err
