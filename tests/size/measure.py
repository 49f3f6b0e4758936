# SPDX-License-Identifier: Apache-2.0
"""Counts the project: functions and their complexity, text lines of each room, words of the pages.

A *room* is a folder of the first, second or (in the generator) third level, such as ``epg/generator/resolve`` or
``docs``.  Its lines are all lines of its text files.  Exports in ``examples``, libraries of others, locks, generated
schemas and expected outputs do not count.  The complexity of a function is McCabe's, as lizard counts it for Python, C
and JavaScript.

A test judges times of the target, or of a simulation.  So the places in sources of tests that read a clock of this
computer, or that sleep, are counted, too: by their text, also in helpers and doubles, and each call of ``soon()``.  A
call of ``until()`` of ``tests/waiting.py`` is not counted: its patience is that for a slow computer, and a test does
not judge it.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path

import lizard
import yaml

from tests.checkout import ROOT, listed

LIMITS = yaml.safe_load((Path(__file__).parent / "limits.yaml").read_text(encoding="utf-8"))
LANGUAGES = {".py": "python", ".c": "c", ".h": "c", ".cpp": "c", ".js": "javascript", ".mjs": "javascript"}
_NOT_COUNTED = re.compile(
    r"(^|/)(examples|vendor|lock|golden)/|^tests/zephyr/generate/|package-lock\.json$|\.(case|svg|png)$"
)


@dataclass(frozen=True)
class Function:
    """A function of EPG itself.  ``lines`` counts from its head to its end."""

    path: str
    name: str
    language: str
    complexity: int
    lines: int

    @property
    def key(self) -> str:
        return f"{self.path} {self.name}"


def files() -> list[str]:
    """The text files that count, relative to the project."""
    return [name for name in listed() if not _NOT_COUNTED.search(name)]


def functions(names: Iterable[str], root: Path = ROOT) -> Iterator[Function]:
    """The functions in the Python, C and JavaScript among the files, without those of the tests."""
    for name in names:
        language = LANGUAGES.get(Path(name).suffix)
        if language is None or "tests" in name.split("/") or "%" in name:  # a template of 20-sim
            continue
        for found in lizard.analyze_file(str(root / name)).function_list:
            lines = found.end_line - found.start_line + 1
            yield Function(name, found.name, language, found.cyclomatic_complexity, lines)


def room_of(name: str) -> str:
    """The room of a file.

    >>> room_of("epg/generator/resolve/search.py"), room_of("docs/boards/rpi_pico.md"), room_of("README.md")
    ('epg/generator/resolve', 'docs', '.')
    """
    folders = name.split("/")[:-1]
    depth = 3 if folders[:2] == ["epg", "generator"] else 2 if folders[:1] in (["epg"], ["targets"], ["tests"]) else 1
    return "/".join(folders[:depth]) or "."


def rooms(names: Iterable[str]) -> Counter[str]:
    """The text lines of each room."""
    lines: Counter[str] = Counter()
    for name in names:
        text = (ROOT / name).read_bytes()
        lines[room_of(name)] += 0 if b"\0" in text else text.count(b"\n")
    return lines


def words(names: Iterable[str]) -> int:
    """The words of all pages."""
    return sum(len((ROOT / name).read_text(encoding="utf-8").split()) for name in names if name.endswith(".md"))


def real_time(names: Iterable[str], kind: str, root: Path = ROOT) -> Iterator[tuple[str, str]]:
    """The places in sources of tests that read a clock of this computer (``clocks``) or sleep (``sleeps``).

    Each as ``file:line`` with its reason: the comment in this line, or in the one above.
    """
    pattern = re.compile(LIMITS["real_time"][kind]["pattern"])
    folders = ((name, name.split("/")[:3]) for name in names if Path(name).suffix in LANGUAGES)
    for name in [name for name, above in folders if "tests" in above and "size" not in above]:
        above = ""
        for number, line in enumerate((root / name).read_text(encoding="utf-8").splitlines(), start=1):
            reason = re.search(r"\s(?:#|//|/\*) (.+)", line) or re.match(r"\s*(?:#|//|/\*|\*) (.+)", above)
            yield from [(f"{name}:{number}", reason[1] if reason else "")] * len(pattern.findall(line))
            above = line


def files_alone() -> int:
    """The test files beside which no other test runs."""
    return len(re.findall(r"^alone ", (ROOT / "tests/tiers.txt").read_text(encoding="utf-8"), re.MULTILINE))
