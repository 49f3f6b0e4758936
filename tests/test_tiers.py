# SPDX-License-Identifier: Apache-2.0
"""The tiers of tests: the tier of each test, the groups that ctest runs, and the report at the end of a run."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

from tests.run import Outcome, costs, read_log, report, unexpected_skips
from tests.tiers import TESTS, TIERS, Group, groups, read_table, table

ROOT = TESTS.parent
FILES = sorted(f"tests/{path.relative_to(TESTS).as_posix()}" for path in TESTS.rglob("test_*.py"))


def test_the_longest_beginning_decides() -> None:
    tiers = read_table(
        "# comment\n\ncheck_all tests/a\ncheck tests/a/test_b.py\ncheck_long tests/a/test_b.py::test_c\n"
    )
    assert tiers.tier("tests/a/test_x.py::test_y") == "check_all"
    assert tiers.tier("tests/a/test_b.py::test_y") == "check"
    assert tiers.tier("tests/a/test_b.py::test_c[1]") == "check_long"
    assert tiers.tier("tests/a/test_b.py::test_cc") == "check"
    assert tiers.tier("tests/ab/test_x.py::test_y") == "check"
    assert tiers.tiers_in("tests/a/test_b.py") == {"check", "check_long"}


def test_an_unknown_tier_is_refused() -> None:
    with pytest.raises(ValueError, match="there is no tier 'long': long tests/a"):
        read_table("long tests/a\n")


def test_every_line_of_the_table_names_something_that_exists() -> None:
    for path in [*table().tiers, *table().alone]:
        file, _, function = path.partition("::")
        assert (ROOT / file).exists(), path
        function = function.partition("[")[0]
        assert f"def {function}(" in (ROOT / file).read_text(encoding="utf-8") if function else True, path


def test_cheap_files_of_a_folder_share_a_test_of_ctest() -> None:
    files = ["tests/a/test_1.py", "tests/a/test_2.py", "tests/a/test_3.py", "tests/b/test_4.py"]
    tiers = read_table("check_long tests/a/test_1.py::test_hours\ncheck_all tests/b\n")
    assert groups(files, tiers, {("check", "tests/a/test_3.py"): 40.0, ("check_all", "tests/b/test_4.py"): 2.0}) == [
        Group("tests.a.3", "check", 40.0, ("tests/a/test_3.py",)),
        Group("tests.a", "check", 2.0, ("tests/a/test_1.py", "tests/a/test_2.py")),
        Group("tests.b.all", "check_all", 2.0, ("tests/b/test_4.py",)),
        Group("tests.a.long", "check_long", 1.0, ("tests/a/test_1.py",)),
    ]


def test_a_file_alone_has_a_test_of_its_own() -> None:
    tiers = read_table("check_all tests/a\nalone tests/a/test_2.py\n")
    assert groups(["tests/a/test_1.py", "tests/a/test_2.py"], tiers, {}) == [
        Group("tests.a.2.all", "check_all", 1.0, ("tests/a/test_2.py",), alone=True),
        Group("tests.a.all", "check_all", 1.0, ("tests/a/test_1.py",)),
    ]


def test_every_file_is_in_a_group_of_each_of_its_tiers() -> None:
    tiers = table()
    made = groups(FILES, tiers, {})
    assert {(file, group.tier) for group in made for file in group.files} == {
        (file, tier) for file in FILES for tier in tiers.tiers_in(file)
    }
    assert len({group.name for group in made}) == len(made)
    assert {group.tier for group in made} == set(TIERS)


def test_the_end_of_a_run_says_what_was_skipped_and_what_was_slow() -> None:
    outcomes = [Outcome(f"tests/test_a.py::test_{i}", float(i), "") for i in range(12)]
    outcomes += [Outcome("tests/test_b.py::test_x", 0.1, "dtc is not installed")] * 2
    lines = report(outcomes).splitlines()
    assert lines[1:3] == ["2 tests were skipped:", "    2  dtc is not installed"]
    assert lines[4:6] == ["The slowest tests:", "  11.0 s  tests/test_a.py::test_11"]
    assert lines[14] == "   2.0 s  tests/test_a.py::test_2"
    assert not any("test_1" in line for line in lines[15:])
    assert costs(outcomes).splitlines()[1:] == ["check        66 tests/test_a.py"]


def test_a_skip_is_expected_by_test_or_by_reason() -> None:
    expected = "# reasons\n*: dtc is not installed\ntests/test_a.py::test_1: no "
    outcomes = [
        Outcome("tests/test_b.py::test_x", 0.1, "dtc is not installed: apt install dtc"),
        Outcome("tests/test_a.py::test_1[x: y]", 0.1, "no network"),
        Outcome("tests/test_a.py::test_2[x: y]", 0.1, "no network"),
        Outcome("tests/test_a.py::test_3", 0.1, ""),
    ]
    assert unexpected_skips(outcomes, expected) == ["tests/test_a.py::test_2: no network"]


def test_pytest_logs_outcomes_and_selects_tiers(tmp_path: Path) -> None:
    """Runs the real pytest with this project's conftest.py."""
    log = tmp_path / "log"
    command = [sys.executable, "-m", "pytest", "-q", "tests/check/test_names.py", "tests/cmake/matrix/test_fetch.py"]
    done = subprocess.run(
        [*command, "-m", "check", "-p", "no:cacheprovider"],
        cwd=ROOT,
        env=environment(log),
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stdout
    outcomes = read_log(log)
    assert {outcome.test.partition("::")[0] for outcome in outcomes} == {"tests/check/test_names.py"}
    assert all(outcome.seconds >= 0 and not outcome.skipped for outcome in outcomes)
    assert json.loads(log.read_text().splitlines()[0]).keys() == {"test", "seconds", "skipped"}


def environment(log: Path) -> dict[str, str]:
    return {**os.environ, "EPG_TEST_LOG": str(log)}
