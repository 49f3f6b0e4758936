# SPDX-License-Identifier: Apache-2.0
"""``docs/errors.md`` has an entry for every kind of message."""

from __future__ import annotations

import re
from pathlib import Path

from epg.cli.messages import Entry, find_entry, read_page

ROOT = Path(__file__).resolve().parent.parent.parent
FIRST_LINE = re.compile(r"^(\S.*: (?:error|warning|note): .* \[([a-z0-9.-]+)\])$", re.MULTILINE)


def ids_in_sources() -> tuple[set[str], set[str]]:
    """The ids in the sources, and patterns for the ids that the sources compose."""
    literal, composed = set(), set()
    for path in (ROOT / "epg").rglob("*.py"):
        text = path.read_text(encoding="utf-8")
        call = r"(?:error|warning|note|report|refuse)\(\s*(?:event,\s*)?"
        literal |= set(re.findall(call + r"""["']([a-z0-9.]+(?:-[a-z0-9.]+)+)["']""", text))
        for form in re.findall(r"""(?:\bid = |error\(|warning\()\s*f["']([a-z0-9{}._-]+)["']""", text):
            composed.add(re.sub(r"\{[^}]*\}", "[a-z0-9_]+", form))
    return literal, composed


def printed() -> dict[str, set[str]]:
    """The first lines of messages in golden files, by id."""
    files = [*(ROOT / "tests/errors/cases").glob("*.case"), *(ROOT / "tests/simulate/wrong").glob("*.txt")]
    lines: dict[str, set[str]] = {}
    for path in files:
        for line, id in FIRST_LINE.findall(path.read_text(encoding="utf-8", errors="replace")):
            lines.setdefault(id, set()).add(line)
    return lines


def test_every_kind_of_message_has_an_entry() -> None:
    literal, composed = ids_in_sources()
    assert len(literal) > 80
    assert composed
    assert sorted(id for id in literal | set(printed()) if find_entry(id) is None) == []
    for form in composed:
        names = (entry.id.lower() for entry in read_page())
        assert any(re.fullmatch(form, name) for name in names), form


def test_every_entry_is_about_a_kind_of_message() -> None:
    literal, composed = ids_in_sources()
    known = literal | set(printed())
    stale = [
        entry.id
        for entry in read_page()
        if not any(entry.covers(id) for id in known)
        and not any(re.fullmatch(form, entry.id.lower()) for form in composed)
    ]
    assert stale == []


def test_entries_explain() -> None:
    entries = read_page()
    assert len({entry.anchor for entry in entries}) == len(entries)
    for entry in entries:
        assert len(entry.text.split()) >= 8, entry.id
        assert entry.summary.endswith("."), entry.id
        assert entry.summary != entry.text, f"{entry.id} says what it means, but not what to do"


def test_entries_for_composed_ids() -> None:
    def named(id: str) -> Entry:
        found = find_entry(id)
        assert found is not None
        return found

    assert named("timer-used-twice").id == "PERIPHERAL-used-twice"
    assert named("pwm-frequency-conflict").id == "PERIPHERAL-ATTRIBUTE-conflict"
    assert named("period-out-of-range").id == "ATTRIBUTE-out-of-range"
    assert named("out-of-range").id == "out-of-range"
    assert named("pin-used-twice").id == "pin-used-twice"
    assert named("yaml-1.1-trap").anchor == "yaml-11-trap"
    assert find_entry("nothing-of-ours") is None
