# SPDX-License-Identifier: Apache-2.0
"""Pages: each link leads to an existing file and heading, each picture is shown, and the project's files agree."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

import epg

ROOT = Path(__file__).resolve().parents[2]
FOLDERS = ("docs", "examples", "integration", "zephyr_module", "tests/doubles/xrce_agent", "tests/doubles/rp2040")
PAGES = sorted([*ROOT.glob("*.md"), *(page for folder in FOLDERS for page in (ROOT / folder).rglob("*.md"))])
LINK = re.compile(r"!?\[[^\]]*\]\(([^)\s]+)\)")
PICTURES = (".png", ".svg")


def links(page: Path) -> list[str]:
    """The targets of a page's links, except those in blocks of code."""
    text = re.sub(r"^```.*?^```", "", page.read_text(encoding="utf-8"), flags=re.DOTALL | re.MULTILINE)
    return LINK.findall(re.sub(r"`[^`\n]*`", "", text))


def anchors(page: Path) -> set[str]:
    """The anchors that GitHub makes from a page's headings."""
    result: set[str] = set()
    for heading in re.findall(r"^#+ (.+)$", page.read_text(encoding="utf-8"), flags=re.MULTILINE):
        words = re.sub(r"[^\w\- ]", "", LINK.sub(lambda link: link[0][1 : link[0].index("]")], heading).lower())
        anchor, number = words.replace(" ", "-"), 1
        while anchor in result:
            anchor, number = f"{words.replace(' ', '-')}-{number}", number + 1
        result.add(anchor)
    return result


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.relative_to(ROOT).as_posix())
def test_links_lead_somewhere(page: Path) -> None:
    broken = []
    for link in links(page):
        if re.match(r"[a-z]+:", link):
            continue
        name, _, anchor = link.partition("#")
        target = (page.parent / name).resolve() if name else page
        if not target.exists() or (anchor and target.suffix == ".md" and anchor not in anchors(target)):
            broken.append(link)
    assert broken == []


def test_each_picture_is_shown() -> None:
    shown = {(page.parent / link).resolve() for page in PAGES for link in links(page) if link.endswith(PICTURES)}
    pictures = {path for path in (ROOT / "docs/pictures").iterdir() if path.suffix in PICTURES}
    assert pictures and pictures <= shown


def test_each_page_is_reached_from_the_readme() -> None:
    reached, waiting = set[Path](), [ROOT / "README.md"]
    while waiting:
        page = waiting.pop()
        if page not in reached:
            reached.add(page)
            names = [link.partition("#")[0] for link in links(page) if not re.match(r"[a-z]+:", link)]
            waiting += [(page.parent / name).resolve() for name in names if name.endswith(".md")]
    assert {page.relative_to(ROOT).as_posix() for page in ROOT.glob("docs/**/*.md") if page not in reached} == set()


def test_the_citation_names_this_version() -> None:
    assert f"\nversion: {epg.__version__}\n" in (ROOT / "CITATION.cff").read_text(encoding="utf-8")
    assert f"\n## {epg.__version__}" in (ROOT / "CHANGELOG.md").read_text(encoding="utf-8")
