# SPDX-License-Identifier: Apache-2.0
"""The tiers of tests: the tier of each test, the groups that ctest runs, and the report at the end of a run."""

from __future__ import annotations

import ast
import json
import os
import re
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.hooks import PRIORITY
from tests.run import (
    BEGINNING,
    Outcome,
    Progress,
    costs,
    costs_text,
    failures,
    read_log,
    report,
    summary,
    unexpected_skips,
    wrong_costs,
)
from tests.tiers import (
    CHECK_ALL_CPU,
    CHECK_CPU,
    TESTS,
    TIERS,
    Group,
    all_groups,
    files_with_tests,
    groups,
    read_costs,
    read_table,
    table,
    text_of,
    unused,
)
from tests.waiting import until

ROOT = TESTS.parent
VERB = re.compile(" (?:is not|are not|does not|cannot|names no) ")
SOURCES = (".py", ".yaml", ".toml", ".json")
FILES = files_with_tests()


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
    """tests/hooks.py also looks for the parameters, in the files that it collects."""
    for path in [*table().tiers, *table().real_time, *table().alone]:
        file, _, function = path.partition("[")[0].partition("::")
        assert (ROOT / file).exists(), path
        assert f"def {function}(" in (ROOT / file).read_text(encoding="utf-8") if function else True, path


def test_a_parameter_selects_all_tests_that_have_it() -> None:
    tiers = read_table("check_all tests/a\ncheck_long tests/a/test_b.py[big]\ncheck tests/a/test_b.py::test_c[big-3]\n")
    assert tiers.tier("tests/a/test_b.py::test_c[big-2]") == "check_long"
    assert tiers.tier("tests/a/test_b.py::test_c[2-big]") == "check_long"
    assert tiers.tier("tests/a/test_b.py::test_c[big-3]") == "check"
    assert tiers.tier("tests/a/test_b.py::test_c[bigger-3]") == "check_all"
    assert tiers.tiers_in("tests/a/test_b.py") == {"check", "check_all", "check_long"}
    assert unused(tiers, ["tests/a/test_b.py::test_c[big-2]"]) == ["tests/a/test_b.py::test_c[big-3]"]
    assert unused(tiers, ["tests/a/test_d.py::test_c"]) == []


def test_every_cost_is_of_a_file_in_its_tier() -> None:
    for tier, file in read_costs(text_of("costs.txt")):
        assert file in FILES, file
        assert tier in table().tiers_in(file), (tier, file)


def test_every_expected_skip_names_a_test_or_a_reason_that_exists() -> None:
    sources = [path for folder in ("tests", "epg", "targets", "integration") for path in (ROOT / folder).rglob("*")]
    text = "\n".join(path.read_text(encoding="utf-8") for path in sources if path.suffix in SOURCES)
    for line in text_of("expected_skips.txt").splitlines():
        if line.startswith(BEGINNING):
            name = VERB.split(line.removeprefix(BEGINNING).removeprefix("EPG: "))[0].removesuffix("-gcc")
            assert name in text, line
        elif line and not line.startswith("#"):
            file, _, function = line.partition("::")
            assert file in FILES, line
            assert f"def {function.partition(':')[0]}" in (ROOT / file).read_text(encoding="utf-8"), line


def test_cheap_files_of_a_folder_share_a_test_of_ctest() -> None:
    files = ["tests/a/test_1.py", "tests/a/test_2.py", "tests/a/test_3.py", "tests/b/test_4.py"]
    tiers = read_table("check_long tests/a/test_1.py::test_hours\ncheck_all tests/b\n")
    assert groups(files, tiers, {("check", "tests/a/test_3.py"): 40.0, ("check_all", "tests/b/test_4.py"): 2.0}) == [
        Group("tests.a.test_3", "check", 40.0, ("tests/a/test_3.py",)),
        Group("tests.a", "check", 2.0, ("tests/a/test_1.py", "tests/a/test_2.py")),
        Group("tests.b.all", "check_all", 2.0, ("tests/b/test_4.py",)),
        Group("tests.a.long", "check_long", 1.0, ("tests/a/test_1.py",)),
    ]


def test_each_test_of_ctest_has_a_name_of_its_own() -> None:
    """A file that takes long can have the name of a folder: test_closed_loop.py and closed_loop."""
    names = [group.name for group in all_groups()]
    assert len(names) > 100 and len(set(names)) == len(names)


def test_many_files_of_a_folder_are_several_tests_of_ctest() -> None:
    files = [f"tests/a/test_{i}.py" for i in range(7)]
    made = groups(files, read_table(""), {("check", file): 14.0 for file in files})
    assert [(group.name, group.cost, len(group.files)) for group in made] == [
        ("tests.a", 56.0, 4),
        ("tests.a.2", 42.0, 3),
    ]


def test_a_file_in_real_time_and_a_file_alone_have_tests_of_their_own() -> None:
    tiers = read_table("check_all tests/a\nalone tests/a/test_2.py\nreal_time tests/a/test_3.py\n")
    assert groups(["tests/a/test_1.py", "tests/a/test_2.py", "tests/a/test_3.py"], tiers, {}) == [
        Group("tests.a.all", "check_all", 1.0, ("tests/a/test_1.py",)),
        Group("tests.a.test_2.all", "check_all", 1.0, ("tests/a/test_2.py",), alone=True),
        Group("tests.a.test_3.all", "check_all", 1.0, ("tests/a/test_3.py",), real_time=True),
    ]


def test_programs_that_run_in_real_time_have_a_better_priority_if_the_user_may_give_it() -> None:
    code = (
        "import os, sys, tests.hooks as it\n"
        "it.prefer(set(sys.argv[1:]), it.Table({}, frozenset({'a', 'b'})))\n"
        "print(os.getpriority(os.PRIO_PROCESS, 0))"
    )
    own = os.getpriority(os.PRIO_PROCESS, 0)

    def priority(*files: str) -> int:
        command = [sys.executable, "-c", code, *files]
        return int(subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True).stdout)

    assert priority("a", "b") == (PRIORITY if os.geteuid() == 0 else own)
    assert priority("a", "c") == priority() == own


def test_a_run_whose_time_is_over_skips_its_tests(tmp_path: Path) -> None:
    log, over = tmp_path / "log", tmp_path / "over"
    test = "tests/test_tiers.py::test_every_cost_is_of_a_file_in_its_tier"
    environment = {**os.environ, "EPG_TEST_LOG": str(log), "EPG_TESTS_OVER": str(over)}
    for _ in range(2):
        command = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", test]
        subprocess.run(command, cwd=ROOT, env=environment, capture_output=True, check=True)
        over.touch()
    assert [outcome.skipped for outcome in read_log(log)] == ["", "the time of this run is over"]


def test_every_file_is_in_a_group_of_each_of_its_tiers() -> None:
    tiers = table()
    made = groups(FILES, tiers, {})
    assert {(file, group.tier) for group in made for file in group.files} == {
        (file, tier) for file in FILES for tier in tiers.tiers_in(file)
    }
    assert len({group.name for group in made}) == len(made)
    assert {group.tier for group in made} == set(TIERS)


def test_the_end_of_a_run_says_what_was_skipped_and_what_was_slow() -> None:
    outcomes = [Outcome(f"tests/test_a.py::test_{i}", float(i), "", cpu=2.0 * i) for i in range(12)]
    outcomes += [Outcome("tests/test_b.py::test_x", 0.1, "dtc is not installed")] * 2
    lines = report(outcomes).splitlines()
    assert lines[1:3] == ["2 tests were skipped:", "    2  dtc is not installed"]
    assert lines[4:6] == ["The slowest tests:", "  11.0 s (22.0 s of CPU)  tests/test_a.py::test_11"]
    assert lines[14] == "   2.0 s (4.0 s of CPU)  tests/test_a.py::test_2"
    assert not any("test_1" in line for line in lines[15:])
    assert summary(outcomes, 2, 1) == "2 entries of ctest, 14 tests, 1 failures, 2 skips, 132 CPU seconds"


def test_costs_are_cpu_seconds_and_an_entry_that_is_far_off_is_told() -> None:
    measured = costs(
        [Outcome("tests/test_a.py::test_1", 1.0, "", cpu=21.0), Outcome("tests/test_b.py::test_1", 9.0, "")]
    )
    assert measured == {("check", "tests/test_a.py"): 21.0, ("check", "tests/test_b.py"): 0.0}
    committed = {
        ("check", "tests/test_a.py"): 10.4,
        ("check", "tests/test_c.py"): 30.0,
        ("check_long", "tests/d.py"): 5.0,
    }
    assert costs_text(measured, committed).splitlines()[1:] == [
        "check        21 tests/test_a.py",
        "check_long    5 tests/d.py",
    ]
    assert wrong_costs(measured, committed) == ["tests/costs.txt: check tests/test_a.py took 21 CPU seconds, not 10"]
    assert wrong_costs(measured, {("check", "tests/test_a.py"): 10.6}) == []
    assert wrong_costs(measured, {("check", "tests/test_a.py"): 9.0}) == []


def test_the_costs_of_check_and_check_all_stay_below_their_limits() -> None:
    spent = dict.fromkeys(TIERS, 0.0)
    for (tier, _), seconds in read_costs(text_of("costs.txt")).items():
        spent[tier] += seconds
    assert spent["check"] <= CHECK_CPU
    assert spent["check"] + spent["check_all"] <= CHECK_ALL_CPU


def test_a_skip_is_expected_by_test_or_by_reason() -> None:
    expected = "# reasons\n*: dtc is not installed\ntests/test_a.py::test_1: no "
    outcomes = [
        Outcome("tests/test_b.py::test_x", 0.1, "dtc is not installed: sudo apt install dtc"),
        Outcome("tests/test_a.py::test_1[x: y]", 0.1, "no network"),
        Outcome("tests/test_a.py::test_2[x: y]", 0.1, "no network"),
        Outcome("tests/test_a.py::test_3", 0.1, ""),
    ]
    assert unexpected_skips(outcomes, expected) == ["tests/test_a.py::test_2: no network"]


def test_no_long_time_passes_without_a_line_and_failures_are_named_at_the_end() -> None:
    file = "tests/connect/test_files.py"
    group = next(each.name for each in all_groups() if file in each.files)

    def ctest() -> Iterator[str]:
        yield "      Start  2: tests.cli\n"
        yield f"      Start 11: {group}\n"
        yield " 1/3 Test  #2: tests.cli ...................   Passed   84.84 sec\n"
        until(lambda: any("after" in line for line in lines))
        yield f" 2/3 Test #11: {group} ...........***Failed    1.00 sec\n"
        yield "      Start 12: tests.cmake.test_stamp\n"
        yield " 3/3 Test #12: tests.cmake.test_stamp ...........***Timeout   1.00 sec\n"

    progress = Progress()
    lines: list[str] = []
    lines.extend(progress.follow(ctest(), silence=0.1))
    assert lines[3] == f"        after 0 min 0 s: {group} ...\n"
    assert [line for line in lines if "after" not in line] == list(ctest())
    assert progress.failed == [group, "tests.cmake.test_stamp"]
    outcomes = [
        Outcome(f"{file}::test_a[b c]", 1.0, "", failed=True),
        Outcome(f"{file}::test_b", 1.0, ""),
    ]
    assert failures(outcomes, progress.failed, Path("build/my tests")) == [
        f"{sys.executable} tests/run.py '{file}::test_a[b c]'",
        "ctest --test-dir 'build/my tests' --output-on-failure -R '^tests\\.cmake\\.test_stamp$'",
    ]
    assert progress.ran == 3
    assert failures(outcomes[1:], [], Path("build")) == []


def test_a_test_runs_alone_by_the_command_that_is_printed() -> None:
    command = [sys.executable, "tests/run.py", "tests/test_tiers.py::test_an_unknown_tier_is_refused"]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout
    assert "1 passed" in done.stdout


def test_the_environment_of_the_caller_does_not_reach_the_programs_that_tests_start() -> None:
    code = "import os, tests.hooks; print(sorted(os.environ))"
    others = ["MAKE_TERMOUT", "MAKEFLAGS", "CLICOLOR_FORCE", "CFLAGS", "CMAKE_GENERATOR", "PYTHONHASHSEED"]
    caller = {**os.environ, **dict.fromkeys(others, "1"), "EPG_PATH": "1"}
    caller["PYTHONPATH"] = os.pathsep.join([str(ROOT), *sys.path[1:]])
    done = subprocess.run(
        [sys.executable, "-c", code], cwd=ROOT, env=caller, capture_output=True, text=True, check=True
    )
    left = ast.literal_eval(done.stdout)
    assert not set(others) & set(left)
    assert {"PYTHONPATH", "EPG_PATH", "PATH"} <= set(left)


def test_a_cause_of_a_skip_has_one_wording() -> None:
    wordings: dict[str, set[str]] = {}
    told = re.compile(r"""["']([^"'{}]+) (?:is|are) not installed: (?:sudo apt|pip) install ([^"'{}]+)""")
    for path in TESTS.rglob("*.py"):
        text = path.read_text(encoding="utf-8")
        assert not re.search(r"(?<!sudo )\bapt(-get)? install (?!cmake\"|python3-jinja2)", text), path
        for program, packages in told.findall(text):
            wordings.setdefault(packages, set()).add(program)
    assert {packages: names for packages, names in wordings.items() if len(names) > 1} == {}


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
    assert sum(outcome.cpu for outcome in outcomes) > 0
    assert json.loads(log.read_text().splitlines()[0]).keys() == {"test", "seconds", "cpu", "skipped", "failed"}


def environment(log: Path) -> dict[str, str]:
    return {**os.environ, "EPG_TEST_LOG": str(log)}
