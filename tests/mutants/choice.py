# SPDX-License-Identifier: Apache-2.0
"""The choice of mutants: a random choice with a seed in each area, or the mutants of earlier results."""

from __future__ import annotations

import random
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from . import c_source, python_source
from .mutant import Identity, Mutant
from .runtime import differs
from .workshop import ROOT

AREAS = {"check": "epg/check/", "resolve": "epg/resolve/", "emit": "epg/emit/", "runtime": "targets/runtime/src/"}
LONG_ENOUGH = 30
"""A statement with this many characters is searched in all functions if the function of its identity lacks it."""


@dataclass(frozen=True)
class Choice:
    """A mutant and its area; the area is empty for a file outside all areas."""

    area: str
    mutant: Mutant


def all_mutants() -> list[Choice]:
    """All mutants of the generator and of the runtime, also of files outside all areas, because statements move."""
    found = []
    for folder, pattern, mutants in (
        ("epg", "*.py", python_source.mutants),
        ("targets/runtime", "*.c", c_source.mutants),
    ):
        for path in sorted((ROOT / folder).rglob(pattern)):
            file = path.relative_to(ROOT).as_posix()
            area = next((area for area, beginning in AREAS.items() if file.startswith(beginning)), "")
            found += [Choice(area, mutant) for mutant in mutants(path.read_text(encoding="utf-8"), file)]
    return found


def choose(everything: Sequence[Choice], area: str, count: int, seed: int, folder: Path) -> list[Choice]:
    """At most one mutant per statement, each with a unique identity."""
    often = Counter(one.mutant.identity for one in everything)
    names = Counter(name for name in {(one.mutant.file, *_statement(one)) for one in everything})
    twice = Counter(name[1:] for name in names)
    found = [one for one in everything if one.area == area and often[one.mutant.identity] == 1]
    random.Random(f"{seed} {area}").shuffle(found)
    chosen: dict[tuple[str, str], Choice] = {}
    for one in found:
        if len(chosen) == count:
            break
        statement = _statement(one)
        if statement in chosen or twice[statement] > 1 or "TYPE_CHECKING" in one.mutant.identity.before:
            continue
        if not one.mutant.file.endswith(".c") or differs(one.mutant, folder):
            chosen[statement] = one
    return list(chosen.values())


def _statement(one: Choice) -> tuple[str, str]:
    return one.mutant.identity.function, one.mutant.identity.before


def find(everything: Sequence[Choice], identity: Identity) -> list[Choice]:
    """The present places of a mutant: in functions of its name, or else in the only other place with its statement."""
    found = [one for one in everything if one.mutant.identity == identity]
    if not found and len(identity.before) >= LONG_ENOUGH:
        changes = (identity.before, identity.after)
        found = [one for one in everything if (one.mutant.identity.before, one.mutant.identity.after) == changes]
        found = found if len(found) == 1 else []
    return found
