# SPDX-License-Identifier: Apache-2.0
"""The table of safety mutants, and their application to a source file."""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path

import yaml

HERE = Path(__file__).resolve().parent
KEYS = ("fault", "before", "after", "test")
_TOKEN = re.compile(
    r"""(?P<skipped>\s+|/\*.*?\*/|//[^\n]*|^[ \t]*\#(?:\\\n|[^\n])*)
    |(?P<text>"(?:\\.|[^"\\])*"|'(?:\\.|[^'\\])*')
    |(?P<word>[A-Za-z_]\w*)
    |(?P<number>\.?\d(?:[eEpP][+-]|[\w.])*)
    |(?P<sign><<=|>>=|->|\+\+|--|<<|>>|<=|>=|==|!=|&&|\|\||[-+*/%&|^]=|.)""",
    re.DOTALL | re.MULTILINE | re.VERBOSE,
)


@dataclass(frozen=True)
class Token:
    kind: str
    text: str
    start: int


@dataclass(frozen=True)
class SafetyMutant:
    group: str
    file: str
    """Path from the root of the project, with slashes."""
    fault: str
    """The wrong behaviour, in words."""
    before: str
    after: str
    program: str
    """``stop`` for ``stop_tests.c``."""
    test: str

    @property
    def name(self) -> str:
        return f"{self.group}: {self.fault}"


def read(folder: Path = HERE) -> list[SafetyMutant]:
    """Reads all files of a folder.  Raises :class:`ValueError` for an entry with other keys."""
    found = []
    for path in sorted(folder.glob("*.yaml")):
        for file, entries in yaml.safe_load(path.read_text(encoding="utf-8")).items():
            for entry in entries:
                if tuple(entry) != KEYS or not all(isinstance(value, str) for value in entry.values()):
                    raise ValueError(f"{path}: a mutant must have the texts {', '.join(KEYS)}: {entry}")
                program, _, test = entry["test"].partition("/")
                texts = [entry[key] for key in ("fault", "before", "after")]
                found.append(SafetyMutant(path.stem, file, *texts, program, test))
    return found


def apply(mutant: SafetyMutant, source: str) -> str:
    """The mutated source.  Raises :class:`ValueError` if ``before`` does not fit exactly one place."""
    whole, part = tokens(source), [token.text for token in tokens(mutant.before)]
    places = [k for k in range(len(whole) - len(part) + 1) if _texts(whole[k : k + len(part)]) == part]
    if len(places) != 1:
        raise ValueError(f"{mutant.file}: {len(places)} places fit: {mutant.before}")
    first, last = whole[places[0]], whole[places[0] + len(part) - 1]
    return source[: first.start] + mutant.after + source[last.start + len(last.text) :]


def tokens(source: str) -> list[Token]:
    found = _TOKEN.finditer(source)
    return [Token(str(m.lastgroup), m.group(), m.start()) for m in found if m.lastgroup != "skipped"]


def _texts(found: list[Token]) -> list[str]:
    return [token.text for token in found]
