# SPDX-License-Identifier: Apache-2.0
"""The words that ``docs/glossary.md`` says are not used, in names of the code and in all texts.

A public class or type of ``epg/``, and most of its files, have a name of their own, too.
"""

from __future__ import annotations

import ast
import io
import keyword
import re
import tokenize
from collections import Counter, defaultdict
from collections.abc import Iterator
from pathlib import Path

from tests.checkout import ROOT, listed

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
LAYERS = "the package is what is done, and the file what it is done to"
SAME_FILES = {
    "application.py": LAYERS,
    "bindings.py": LAYERS,
    "claims.py": LAYERS,
    "flash.py": "connect/run starts what system does",
    "hardware.py": LAYERS,
    "judge.py": "a recording of a motor is judged, or a run by its scenario",
    "merge.py": "check has the rules of .tcf files, documents those of all YAML documents",
    "messages.py": LAYERS,
    "middleware.py": LAYERS,
    "model.py": LAYERS,
    "motors.py": LAYERS,
    "other_code.py": LAYERS,
    "parameters.py": LAYERS,
    "picture.py": "the picture of its package",
    "pins.py": LAYERS,
    "tcf.py": LAYERS,
    "text.py": "the texts of its package: those of a terminal, and those of generated files",
    "topics.py": LAYERS,
}
"""Names of several files of ``epg/``, with the reason.  A subcommand in ``epg/cli`` has the name of its work."""
UNNAMED = set("Access Agent Console Fault Item Lateness Macro PortLayer Robot Sample Setpoint Transport".split())
"""Classes with the name and the meaning of a term, whose entry does not name them."""
_C = re.compile(r'"(?:\\.|[^"\\\n])*"|\'(?:\\.|[^\'\\\n])*\'|/\*.*?\*/|//[^\n]*', re.DOTALL)


def table(heading: str) -> list[str]:
    """The words in the first column of the glossary's table under ``heading``, without code marks."""
    section = GLOSSARY.read_text(encoding="utf-8").partition(f"\n{heading}\n")[2].partition("\n## ")[0]
    rows = [line.split("|")[1] for line in section.splitlines() if line.startswith("| ") and "---" not in line]
    return [word.strip() for row in rows[1:] for word in row.replace("`", "").split(",")]


def files(*patterns: str) -> list[Path]:
    """The project's files, without exports and golden output."""
    return [ROOT / name for name in listed("--", *patterns) if not re.search(r"(^|/)(model|plant|golden|lock)/", name)]


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


def type_names(path: Path) -> Iterator[str]:
    """The public classes and aliases of types at the top of a Python file: ``Row``, not ``ROWS``."""
    for node in ast.parse(path.read_text(encoding="utf-8")).body:
        if isinstance(node, ast.ClassDef):
            yield node.name
        elif isinstance(node, ast.Assign | ast.AnnAssign):
            targets = node.targets if isinstance(node, ast.Assign) else [node.target]
            yield from (target.id for target in targets if isinstance(target, ast.Name))


def test_a_class_has_a_name_of_its_own() -> None:
    found = defaultdict(list)
    for path in files("epg/*.py"):
        for name in type_names(path):
            if re.match(r"[A-Z]\w*[a-z]", name):
                found[name].append(str(path.relative_to(ROOT)))
    assert len(found) > 400
    assert {name: paths for name, paths in found.items() if len(paths) > 1} == {}


def test_a_file_has_a_name_of_its_own() -> None:
    names = Counter(path.name for path in files("epg/*.py") if path.parent.name != "cli" and path.stem != "__init__")
    assert {name for name, count in names.items() if count > 1} == SAME_FILES.keys()


def class_names(place: Path) -> list[str]:
    """The classes at the top of a Python file, or of all files in a folder, of ``epg`` or of its generator."""
    place = place if place.exists() or place.with_suffix(".py").exists() else ROOT / "epg/generator" / place.name
    paths = sorted(place.rglob("*.py")) if place.is_dir() else [place.with_suffix(".py")]
    bodies = [ast.parse(path.read_text(encoding="utf-8")).body for path in paths]
    return [node.name for body in bodies for node in body if isinstance(node, ast.ClassDef)]


def entries() -> list[tuple[list[str], list[str]]]:
    """The terms of each entry, and the classes that it names."""
    lines = GLOSSARY.read_text(encoding="utf-8").partition("\n## Words that are not used\n")[0].splitlines()
    rows = [line.strip("| ").split(" | ", 1) for line in lines if line.startswith("| ") and "---" not in line]
    return [
        ([term.strip("` ") for term in names.split(",")], re.findall(r"[Cc]lass `([\w.]+)`", meaning))
        for names, meaning in rows
        if names != "term"
    ]


def test_a_class_with_the_name_of_a_term_has_its_meaning() -> None:
    named = {re.sub("[ -]", "", term).lower(): found for terms, found in entries() for term in terms}
    types = {name for path in files("epg/*.py") for name in type_names(path) if not name.isupper()}
    assert {name for name in types if not named.get(name.lower(), [name])} == UNNAMED


def test_each_class_of_an_entry_exists() -> None:
    """An entry names at most one class, ``package.Class`` in ``epg``, and its term has no other entry."""
    terms = [term for names, _ in entries() for term in names]
    assert len(terms) > 70 and len(set(terms)) == len(terms)
    classes = [name for _, found in entries() for name in found]
    assert [names for names, found in entries() if len(found) > 1] == []
    assert len(classes) > 25 and len(set(classes)) == len(classes)
    missing = []
    for name in classes:
        package, _, of_class = name.rpartition(".")
        if class_names(ROOT / "epg" / package).count(of_class) != 1:
            missing.append(name)
    assert missing == []
