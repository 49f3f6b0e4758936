# SPDX-License-Identifier: Apache-2.0
"""The tier of each test, and the groups of test files that ctest runs as one test.

``tests/tiers.txt`` names the tests of ``check_all`` and ``check_long``; all others belong to ``check``.
``tests/costs.txt`` lists the CPU time that each file takes.  A folder in ``integration`` has these files for its tests.

>>> table = read_table("check_all  tests/ros2\\ncheck_long tests/ros2/test_a.py::test_hours\\n")
>>> table.tier("tests/ros2/test_a.py::test_minutes[3]"), table.tier("tests/ros2/test_a.py::test_hours[3]")
('check_all', 'check_long')
"""

from __future__ import annotations

import re
import sys
from collections import defaultdict
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

TESTS = Path(__file__).resolve().parent
ROOT = TESTS.parent
TIERS = ("check", "check_all", "check_long")
ALONE = 15.0
"""Limit in CPU seconds: ctest runs a costlier file as a test by itself.  A start of pytest takes one second."""
TOGETHER = 60.0
"""Limit in CPU seconds for files that share a test of ctest, so that no test is the last one for long."""
CHECK_CPU = 300
"""Limit in CPU seconds for all files of ``check`` in tests/costs.txt."""
CHECK_ALL_CPU = 3420
"""Limit in CPU seconds for all files of the target ``check_all``, which also runs those of ``check``."""


@dataclass(frozen=True)
class Table:
    """The beginnings of test names, as pytest writes them, each with its tier."""

    tiers: Mapping[str, str]
    real_time: frozenset[str] = frozenset()
    """Files whose programs run in real time.  They have a better scheduling priority, and ctest runs one at a time."""
    alone: frozenset[str] = frozenset()
    """Files beside which ctest runs no other test."""

    def tier(self, test: str) -> str:
        """The tier of a test: the longest matching beginning of its name decides."""
        found = [path for path in self.tiers if begins(test, path)]
        return self.tiers[max(found, key=len)] if found else TIERS[0]

    def tiers_in(self, file: str) -> set[str]:
        """The tiers of the tests in a file."""
        return {self.tier(file)} | {
            tier for path, tier in self.tiers.items() if path.startswith((f"{file}::", f"{file}["))
        }


@dataclass(frozen=True)
class Group:
    """Files of which ctest runs all tests of one tier as one test."""

    name: str
    tier: str
    cost: float
    """CPU time for all files, in seconds."""
    files: tuple[str, ...]
    real_time: bool = False
    """Whether ctest begins it early, and runs no other group with this mark at the same time."""
    alone: bool = False
    """Whether ctest runs no other test at the same time."""


def begins(test: str, path: str) -> bool:
    """True if ``path`` names the test or contains it: a folder, a file or a function, with a parameter or without.

    >>> begins("tests/test_a.py::test_b[freertos-3]", "tests/test_a.py[freertos]")
    True
    """
    place, _, parameter = path.partition("[")
    function, _, parameters = test.partition("[")
    if parameter and f"-{parameter.removesuffix(']')}-" not in f"-{parameters.removesuffix(']')}-":
        return False
    return function == place or (function.startswith(place) and function[len(place)] in "/:")


def unused(tiers: Table, tests: Sequence[str]) -> list[str]:
    """Beginnings in the table that name none of ``tests``, which are all tests of their files."""
    files = {test.partition("::")[0] for test in tests}
    return [
        path
        for path in tiers.tiers
        if re.split(r"::|\[", path)[0] in files and not any(begins(test, path) for test in tests)
    ]


def read_table(text: str) -> Table:
    """Reads lines ``tier path``, ``real_time file`` and ``alone file``.  Ignores empty lines and comments (``#``).

    A list in braces stands for one line for each of its names.  Raises :class:`ValueError` for another tier.

    >>> sorted(read_table("check_long tests/a/{test_b.py,test_c.py}[freertos]").tiers)
    ['tests/a/test_b.py[freertos]', 'tests/a/test_c.py[freertos]']
    """
    tiers: dict[str, str] = {}
    marked: dict[str, set[str]] = {"real_time": set(), "alone": set()}
    for line in text.splitlines():
        if line and not line.startswith("#"):
            tier, names = line.split(maxsplit=1)
            if tier in marked:
                marked[tier].update(_expanded(names))
            elif tier in TIERS:
                tiers |= dict.fromkeys(_expanded(names), tier)
            else:
                raise ValueError(f"tests/tiers.txt: there is no tier {tier!r}: {line}")
    return Table(tiers, frozenset(marked["real_time"]), frozenset(marked["alone"]))


def _expanded(names: str) -> list[str]:
    """All names for which ``names`` stands: ``a{b,c}d`` are ``abd`` and ``acd``."""
    begin, brace, rest = names.partition("{")
    if not brace:
        return [names]
    choices, _, end = rest.partition("}")
    return [name for choice in choices.split(",") for name in _expanded(begin + choice + end)]


def text_of(name: str) -> str:
    """The text of ``tests/<name>``, or of the file ``name``, and of the files of this name in ``integration``."""
    files = (TESTS / name, *sorted(ROOT.glob(f"integration/*/tests/{Path(name).name}")))
    return "\n".join(file.read_text(encoding="utf-8") for file in files)


def files_with_tests() -> list[str]:
    """The files with tests, relative to the project."""
    found = (*TESTS.rglob("test_*.py"), *ROOT.glob("integration/*/tests/**/test_*.py"))
    return sorted(path.relative_to(ROOT).as_posix() for path in found)


def table() -> Table:
    """The table in tests/tiers.txt."""
    return read_table(text_of("tiers.txt"))


def read_costs(text: str) -> dict[tuple[str, str], float]:
    """CPU seconds by tier and file, from lines ``tier seconds file``."""
    rows = (line.split(maxsplit=2) for line in text.splitlines() if line and not line.startswith("#"))
    return {(tier, file): float(seconds) for tier, seconds, file in rows}


def groups(files: Iterable[str], tiers: Table, costs: Mapping[tuple[str, str], float]) -> list[Group]:
    """All tests of ctest.  Files of a folder that take little time share one test; each other file has its own."""
    together: dict[tuple[str, str], list[str]] = defaultdict(list)
    for file in sorted(files):
        for tier in sorted(tiers.tiers_in(file)):
            own = costs.get((tier, file), 0.0) > ALONE or file in tiers.real_time | tiers.alone
            name = file.removesuffix(".py") if own else str(Path(file).parent.as_posix())
            together[name, tier].append(file)
    result = []
    for (name, tier, part), members in _parts(together, costs).items():
        suffix = (f".{part}" if part > 1 else "") + {"check": "", "check_all": ".all", "check_long": ".long"}[tier]
        cost = sum(costs.get((tier, file), 1.0) for file in members)
        marks = [not marked.isdisjoint(members) for marked in (tiers.real_time, tiers.alone)]
        result.append(Group(name.replace("/", ".") + suffix, tier, cost, tuple(members), *marks))
    return sorted(result, key=lambda group: (TIERS.index(group.tier), -group.cost, group.name))


def _parts(
    together: Mapping[tuple[str, str], Sequence[str]], costs: Mapping[tuple[str, str], float]
) -> dict[tuple[str, str, int], list[str]]:
    """Splits the files of each name and tier, in their order, into parts that cost at most :data:`TOGETHER`."""
    result: dict[tuple[str, str, int], list[str]] = {}
    for (name, tier), files in together.items():
        part, cost = 1, 0.0
        for file in files:
            more = costs.get((tier, file), 1.0)
            if cost and cost + more > TOGETHER:
                part, cost = part + 1, 0.0
            cost += more
            result.setdefault((name, tier, part), []).append(file)
    return result


def all_groups() -> list[Group]:
    """The groups of all test files, as tests/costs.txt says."""
    return groups(files_with_tests(), table(), read_costs(text_of("costs.txt")))


def main() -> int:
    """Prints ``name|tier|cost|real_time|alone|file,file`` per group, for tests/CMakeLists.txt."""
    for group in all_groups():
        marks = f"{group.real_time}|{group.alone}"
        print(f"{group.name}|{group.tier}|{group.cost:.0f}|{marks}|{','.join(group.files)}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
