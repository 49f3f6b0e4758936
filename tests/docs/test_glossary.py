# SPDX-License-Identifier: Apache-2.0
"""The words that ``docs/glossary.md`` says are not used, in names of the code and in all texts."""

from __future__ import annotations

import io
import keyword
import re
import shutil
import subprocess
import tokenize
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
GLOSSARY = ROOT / "docs/glossary.md"
TEXTS = (
    "*.py",
    "*.c",
    "*.h",
    "*.j2",
    "*.cmake",
    "CMakeLists.txt",
    "*.md",
    "*.yaml",
    "*.js",
    "*.mjs",
    "*.tcf",
    "*.case",
)
MOST_PHRASES = 30
_C = re.compile(r'"(?:\\.|[^"\\\n])*"|\'(?:\\.|[^\'\\\n])*\'|/\*.*?\*/|//[^\n]*', re.DOTALL)


def table(heading: str) -> list[str]:
    """The words in the first column of the glossary's table under ``heading``, without code marks."""
    section = GLOSSARY.read_text(encoding="utf-8").partition(f"\n{heading}\n")[2].partition("\n## ")[0]
    rows = [line.split("|")[1] for line in section.splitlines() if line.startswith("| ") and "---" not in line]
    return [word.strip() for row in rows[1:] for word in row.replace("`", "").split(",")]


def files(*patterns: str) -> list[Path]:
    """The project's files, without exports and golden output."""
    if shutil.which("git") is None:
        pytest.skip("git is not installed: apt install git")
    listed = subprocess.run(["git", "-C", str(ROOT), "ls-files", "--", *patterns], capture_output=True, text=True)
    if listed.returncode != 0:
        pytest.skip("this is no checkout of git: apt install git")
    names = [name for name in listed.stdout.splitlines() if not re.search(r"(^|/)(model|plant|golden|lock)/", name)]
    return [ROOT / name for name in names if (ROOT / name).is_file()]


def python_names(path: Path) -> set[str]:
    """The names that a Python file uses, without the methods that it calls."""
    tokens = list(tokenize.generate_tokens(io.StringIO(path.read_text(encoding="utf-8")).readline))
    following = [*tokens[1:], tokens[-1]]
    before = [tokens[0], *tokens[:-1]]
    return {
        token.string
        for token, next_one, previous in zip(tokens, following, before)
        if token.type == tokenize.NAME
        and not keyword.iskeyword(token.string)
        and not (previous.string == "." and next_one.string == "(")
    }


def c_names(path: Path) -> set[str]:
    """The names in a C file, without its strings and comments."""
    return set(re.findall(r"\b[A-Za-z_]\w*\b", _C.sub(" ", path.read_text(encoding="utf-8", errors="replace"))))


def test_no_name_has_a_word_that_is_not_used() -> None:
    """The last word of a name is its noun: ``sort_keys`` has keys."""
    words = table("### In names")
    assert words
    found = []
    for path in files("epg/*.py", "tests/*.py", "benchmarks/*.py", "targets/*.c", "targets/*.h", "tests/*.c"):
        names = python_names(path) if path.suffix == ".py" else c_names(path)
        nouns = {name.lower().rpartition("_")[2] for name in names}
        found += [f"{path.relative_to(ROOT)}: {word}" for word in words if word in nouns]
    assert found == []


def test_no_text_has_a_phrase_that_is_not_used() -> None:
    phrases = table("### In texts")
    assert 10 <= len(phrases) <= MOST_PHRASES
    one = re.compile(r"\b(" + "|".join(phrase.replace(" ", r"\s+") for phrase in phrases) + r")\b", re.IGNORECASE)
    found = []
    for path in files(*TEXTS):
        if path not in (GLOSSARY, Path(__file__).resolve()):
            text = path.read_text(encoding="utf-8", errors="replace")
            found += [
                f"{path.relative_to(ROOT)}:{text.count(chr(10), 0, m.start()) + 1}: {m[0]}" for m in one.finditer(text)
            ]
    assert found == []
