# SPDX-License-Identifier: Apache-2.0
"""The tier of each test, and the groups of test files that ctest runs as one test.

``tests/tiers.txt`` names the tests of ``check_all`` and ``check_long``; all others belong to ``check``.
``tests/costs.txt`` lists the time that each file takes.

>>> table = read_table("check_all  tests/ros2\\ncheck_long tests/ros2/test_a.py::test_hours\\n")
>>> table.tier("tests/ros2/test_a.py::test_minutes[3]"), table.tier("tests/ros2/test_a.py::test_hours[3]")
('check_all', 'check_long')
"""

from __future__ import annotations

import sys
from collections import defaultdict
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path

TESTS = Path(__file__).resolve().parent
TIERS = ("check", "check_all", "check_long")
ALONE = 15.0
"""Limit in seconds: ctest runs a file that takes longer as a test by itself.  A start of pytest takes one second."""


@dataclass(frozen=True)
class Table:
    """The beginnings of test names, as pytest writes them, each with its tier."""

    tiers: Mapping[str, str]
    alone: frozenset[str] = frozenset()
    """Files beside which ctest runs no other test."""

    def tier(self, test: str) -> str:
        """The tier of a test: the longest matching beginning of its name decides."""
        found = [path for path in self.tiers if begins(test, path)]
        return self.tiers[max(found, key=len)] if found else TIERS[0]

    def tiers_in(self, file: str) -> set[str]:
        """The tiers of the tests in a file."""
        return {self.tier(file)} | {tier for path, tier in self.tiers.items() if path.startswith(f"{file}::")}


@dataclass(frozen=True)
class Group:
    """Files of which ctest runs all tests of one tier as one test."""

    name: str
    tier: str
    cost: float
    """Time for all files, in seconds."""
    files: tuple[str, ...]
    alone: bool = False
    """Whether ctest runs no other test at the same time."""


def begins(test: str, path: str) -> bool:
    """True if ``path`` names the test or contains it: a folder, a file, a function or a parameter."""
    return test == path or (test.startswith(path) and test[len(path)] in "/:[")


def read_table(text: str) -> Table:
    """Reads lines ``tier path`` and ``alone file``.  Ignores empty lines and lines that begin with ``#``.

    Raises :class:`ValueError` for another tier.
    """
    tiers, alone = {}, set()
    for line in text.splitlines():
        if line and not line.startswith("#"):
            tier, path = line.split(maxsplit=1)
            if tier == "alone":
                alone.add(path)
                continue
            if tier not in TIERS:
                raise ValueError(f"tests/tiers.txt: there is no tier {tier!r}: {line}")
            tiers[path] = tier
    return Table(tiers, frozenset(alone))


def table() -> Table:
    """The table in tests/tiers.txt."""
    return read_table((TESTS / "tiers.txt").read_text(encoding="utf-8"))


def read_costs(text: str) -> dict[tuple[str, str], float]:
    """Seconds by tier and file, from lines ``tier seconds file``."""
    rows = (line.split(maxsplit=2) for line in text.splitlines() if line and not line.startswith("#"))
    return {(tier, file): float(seconds) for tier, seconds, file in rows}


def groups(files: Iterable[str], tiers: Table, costs: Mapping[tuple[str, str], float]) -> list[Group]:
    """All tests of ctest.  Files of a folder that take little time share one test; each other file has its own."""
    together: dict[tuple[str, str], list[str]] = defaultdict(list)
    for file in sorted(files):
        for tier in sorted(tiers.tiers_in(file)):
            own = costs.get((tier, file), 0.0) > ALONE or file in tiers.alone
            name = file.removesuffix(".py") if own else str(Path(file).parent.as_posix())
            together[name, tier].append(file)
    result = []
    for (name, tier), members in together.items():
        words = [word.removeprefix("test_") for word in name.split("/")]
        suffix = {"check": "", "check_all": ".all", "check_long": ".long"}[tier]
        cost = sum(costs.get((tier, file), 1.0) for file in members)
        result.append(Group(".".join(words) + suffix, tier, cost, tuple(members), not tiers.alone.isdisjoint(members)))
    return sorted(result, key=lambda group: (TIERS.index(group.tier), -group.cost, group.name))


def main() -> int:
    """Prints ``name|tier|cost|alone|file,file`` per group, for tests/CMakeLists.txt."""
    files = [f"tests/{path.relative_to(TESTS).as_posix()}" for path in TESTS.rglob("test_*.py")]
    costs = read_costs((TESTS / "costs.txt").read_text(encoding="utf-8"))
    for group in groups(files, table(), costs):
        print(f"{group.name}|{group.tier}|{group.cost:.0f}|{group.alone}|{','.join(group.files)}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
