# SPDX-License-Identifier: Apache-2.0
"""Every message of EPG, to the letter.

A file ``cases/<name>.case`` has the wrong files and EPG's messages about them::

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
``targets`` is in ``EPG_TARGETS_PATH``.  The command may begin with variables of the environment, as in a shell.
``EPG_UPDATE_GOLDEN=1`` rewrites the expected messages: review the difference.
"""

from __future__ import annotations

import json
import os
import re
import shutil
from pathlib import Path

import pytest

from epg.cli.main import main
from epg.diagnostics import Diagnostics
from epg.emit.cmake import PathNames
from epg.emit.outputs import application_outputs
from epg.system.check_system import check_system
from epg.system.load_system import load_system
from epg.tools import usb_boards

HERE = Path(__file__).resolve().parent
CASES = sorted((HERE / "cases").glob("*.case"))
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
    return command, files, files.pop("expected", "")


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


@pytest.mark.parametrize("case", CASES, ids=lambda path: path.stem)
def test_message(
    case: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
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
    status = main(arguments.split())
    output = capfd.readouterr()
    assert "Traceback" not in output.err
    if os.environ.get("EPG_UPDATE_GOLDEN"):
        text = case.read_text(encoding="utf-8")
        head = re.split(r"^--- expected\n", text, flags=re.MULTILINE)[0]
        case.write_text(f"{head}--- expected\n{output.err}", encoding="utf-8")
        expected = output.err
    assert output.err == expected
    assert status == (1 if ": error: " in expected else 0)
    assert re.search(r": (error|warning|note): .* \[[a-z0-9.-]+\]$", expected, re.MULTILINE)


def test_every_kind_of_message_has_a_case() -> None:
    """The ids in EPG's sources are those in the cases (modules of the simulation have their own tests)."""
    root = HERE.parent.parent / "epg"
    ids = set()
    for path in root.rglob("*.py"):
        if "simulate" in path.parts:
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
