# SPDX-License-Identifier: Apache-2.0
"""The file of results: one mutant on each line, its fields separated by tabs.

``state``, area, function, statement before, statement after, and for an equivalent mutant the reason.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

from .mutant import Identity

CAUGHT, SURVIVED, EQUIVALENT = STATES = ("caught", "survived", "equivalent")
HEAD = """\
# Written by python -m tests.mutants --choose; docs/development.md says how it is used.
# The states of survivors that change nothing a user can see were set to `equivalent` by hand, with the reason.
"""


@dataclass(frozen=True)
class Result:
    state: str
    area: str
    identity: Identity
    reason: str = ""


def read(path: Path) -> list[Result]:
    """Reads the results.  Raises :class:`ValueError` for a line that is not a result."""
    results = []
    for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1):
        if not line or line.startswith("#"):
            continue
        state, *fields = line.split("\t")
        if state not in STATES or len(fields) != (5 if state == EQUIVALENT else 4):
            raise ValueError(f"{path}:{number}: this is not a result: {line}")
        results.append(Result(state, fields[0], Identity(*fields[1:4]), *fields[4:]))
    return results


def write(path: Path, results: Iterable[Result]) -> None:
    lines = []
    for result in results:
        found = result.identity
        fields = [result.state, result.area, found.function, found.before, found.after]
        lines.append("\t".join(fields + ([result.reason] if result.reason else [])) + "\n")
    path.write_text(HEAD + "".join(sorted(lines)), encoding="utf-8")
