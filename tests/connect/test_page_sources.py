# SPDX-License-Identifier: Apache-2.0
"""The sources of the page: a script uses each export and each class of the style sheet."""

from __future__ import annotations

import re
from pathlib import Path

from epg.connect.session import Session

ROOT = Path(__file__).resolve().parents[2]
PAGE = ROOT / "epg/connect/page"
SCRIPTS = {path.name: path.read_text(encoding="utf-8") for path in sorted(PAGE.glob("*.js"))}


def test_each_export_is_imported() -> None:
    assert len(SCRIPTS) > 20
    imported = {
        (Path(file).name, name.split(" as ")[0].strip())
        for text in SCRIPTS.values()
        for names, file in re.findall(r"^import \{([^}]*)\} from \"([^\"]+)\";", text, re.MULTILINE)
        for name in names.split(",")
    }
    exported = [
        (file, name)
        for file, text in SCRIPTS.items()
        for name in re.findall(r"^export (?:async )?(?:function|const|let) (\w+)", text, re.MULTILINE)
    ]
    assert [f"{file}: {name}" for file, name in exported if (file, name) not in imported] == []


def test_each_script_is_loaded() -> None:
    everything = "".join(SCRIPTS.values()) + (PAGE / "index.html").read_text(encoding="utf-8")
    assert [name for name in SCRIPTS if not re.search(rf'"(\./)?{re.escape(name)}"', everything)] == []


def test_each_type_is_used() -> None:
    types = (PAGE / "types.d.ts").read_text(encoding="utf-8")
    used = re.sub(r"^(interface|type) \w+", "", types, flags=re.MULTILINE) + "".join(SCRIPTS.values())
    names = set(re.findall(r"^(?:interface|type) (\w+)", types, re.MULTILINE)) - {"Document", "Element", "SystemState"}
    assert len(names) > 20
    assert sorted(name for name in names if not re.search(rf"\b{name}\b", used)) == []


def test_the_actions_are_those_of_a_session() -> None:
    types = (PAGE / "types.d.ts").read_text(encoding="utf-8")
    body = types.partition("interface Actions {\n")[2].partition("\n}\n")[0]
    session = Session([], model=ROOT / "examples/jiwy/model")
    assert sorted(re.findall(r"^  (\w+):", body, re.MULTILINE)) == sorted(session.actions)


def test_each_class_of_the_style_sheet_is_in_a_script() -> None:
    """A script may also compose a class: ``dock-${ui.dock}``."""
    style = re.sub(r"/\*.*?\*/", "", (PAGE / "style.css").read_text(encoding="utf-8"), flags=re.DOTALL)
    selectors = " ".join(re.findall(r"[^{}]+(?=\{)", style))
    names = set(re.findall(r"[.#]([a-zA-Z][\w-]*)", selectors))
    assert len(names) > 80
    used = "".join(SCRIPTS.values()) + (PAGE / "index.html").read_text(encoding="utf-8")
    words = set(re.findall(r"[a-zA-Z][\w-]*", used))
    starts = set(re.findall(r"([a-zA-Z][\w-]*-)\$\{", used))
    composed = {start + end for start in starts for end in (*words, *"0123456789")}
    assert sorted(names - words - composed) == []


def test_each_variable_of_the_style_sheet_is_set_and_used() -> None:
    style = (PAGE / "style.css").read_text(encoding="utf-8")
    assert set(re.findall(r"(--[\w-]+)\s*:", style)) == set(re.findall(r"var\((--[\w-]+)", style))
