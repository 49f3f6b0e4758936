# SPDX-License-Identifier: Apache-2.0
"""Pages: no 25 words stand twice in a row on two pages.  One page says it, and the others link to it."""

from __future__ import annotations

import re
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md"))]
LENGTH = 25


def runs(text: str) -> set[tuple[str, ...]]:
    """All runs of words in the prose of a page: no blocks of code, no tables, no targets of links."""
    prose = re.sub(r"^ *```.*?^ *```|^ *\|.*?$|<!--.*?-->", "", text, flags=re.DOTALL | re.MULTILINE)
    words = re.findall(r"\w+", re.sub(r"\]\([^)]*\)", "]", prose).lower())
    return {tuple(words[start : start + LENGTH]) for start in range(len(words) - LENGTH + 1)}


def test_no_sentence_stands_on_two_pages() -> None:
    seen: dict[tuple[str, ...], str] = {}
    repeats: dict[tuple[str, str], str] = {}
    for page in PAGES:
        name, found = page.relative_to(ROOT).as_posix(), runs(page.read_text(encoding="utf-8"))
        repeats.update({(seen[run], name): " ".join(run) for run in sorted(found & seen.keys(), reverse=True)})
        seen.update(dict.fromkeys(found - seen.keys(), name))
    assert repeats == {}


def test_code_tables_and_targets_of_links_are_no_prose() -> None:
    words = " ".join(f"word{number}" for number in range(LENGTH))
    assert len(runs(f"{words.replace(' word9', chr(10) + '*Word9*')}.")) == 1
    assert runs(words.replace("word9", "[word9](page.md#anchor)")) == runs(words)
    for left_out in (f"```\n{words}\n```", f"| {words} |", f"- item\n\n  ```sh\n  {words}\n  ```\n"):
        assert runs(left_out) == set()
