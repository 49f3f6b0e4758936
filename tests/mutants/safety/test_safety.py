# SPDX-License-Identifier: Apache-2.0
"""Each safety mutant is noticed by the test that its entry names."""

from __future__ import annotations

from collections import Counter
from pathlib import Path

import pytest

from .programs import FAILED_CHECK, PROGRAMS, SOURCES, Programs, names_of
from .table import SafetyMutant, apply, read

MUTANTS = read()
GROUPS = (
    *("stop", "lease", "fail_safe", "fault_latch", "guards", "safe_outputs"),
    *("watchdog", "timeouts", "enabling_again", "initialising_again"),
)
"""The groups that must have at least four mutants each."""


@pytest.fixture(scope="module")
def programs(tmp_path_factory: pytest.TempPathFactory) -> Programs:
    return Programs(tmp_path_factory.mktemp("safety"))


@pytest.mark.parametrize("mutant", MUTANTS, ids=lambda mutant: mutant.name)
def test_a_mutant_is_noticed(programs: Programs, mutant: SafetyMutant) -> None:
    status = programs.status_with(mutant)
    assert status != 0, f"{mutant.program}/{mutant.test} does not notice that {mutant.fault}"
    assert status == FAILED_CHECK, f"{mutant.program}/{mutant.test} crashed: it has no check for this"


@pytest.mark.parametrize("name", sorted({mutant.program for mutant in MUTANTS}))
def test_without_a_mutant_the_tests_pass(programs: Programs, name: str) -> None:
    tests = {mutant.test for mutant in MUTANTS if mutant.program == name}
    assert tests - set(names_of(name)) == set()
    assert [test for test in sorted(tests) if programs.status(name, test) != 0] == []


def test_each_group_has_enough() -> None:
    found = Counter(mutant.group for mutant in MUTANTS)
    assert [group for group in GROUPS if found[group] < 4] == []
    assert found.total() >= 60
    names = [mutant.name for mutant in MUTANTS]
    assert [name for name in names if names.count(name) > 1] == []


def test_a_mutant_must_fit_one_place() -> None:
    mutant = SafetyMutant("stop", "f.c", "it is wrong", "x = 1;", "x = 2;", "stop", "test")
    assert apply(mutant, "y = 1; x\n  = 1; /* why */ z = 1;") == "y = 1; x = 2; /* why */ z = 1;"
    for source in ("y = 1;", "x = 1; x = 1;"):
        with pytest.raises(ValueError, match=r"f\.c: [02] places fit: x = 1;"):
            apply(mutant, source)


def test_a_mutant_that_does_not_compile_is_an_error(programs: Programs) -> None:
    mutant = MUTANTS[0]
    wrong = SafetyMutant(mutant.group, mutant.file, "", mutant.before, "not C;", mutant.program, mutant.test)
    with pytest.raises(ValueError, match="the mutant does not compile"):
        programs.status_with(wrong)


def test_a_table_with_other_keys_is_an_error(tmp_path: Path) -> None:
    (tmp_path / "stop.yaml").write_text("f.c:\n  - fault: it is wrong\n", encoding="utf-8")
    with pytest.raises(ValueError, match="a mutant must have the texts fault, before, after, test"):
        read(tmp_path)


def test_programs_have_different_names() -> None:
    assert len(SOURCES) == len(PROGRAMS)
