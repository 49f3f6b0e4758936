# SPDX-License-Identifier: Apache-2.0
"""Settings for all tests, which conftest.py loads: every outcome is logged for tests/run.py.

The log has the CPU time of each test: user and system time of pytest and of the child processes that it has waited for.
A child that outlives its test counts in the test that waits for it.
"""

from __future__ import annotations

import contextlib
import json
import os
import re
from collections import defaultdict
from collections.abc import Iterator

import pytest

from tests.compiler_cache import share_objects
from tests.tiers import Table, table, unused

PRIORITY = -15
"""Nice value of tests whose programs run in real time, from -20 (best) to 19."""

_OTHERS = re.compile(r"MAKE|MFLAGS$|CLICOLOR|FORCE_COLOR$|NO_COLOR$|(C|CXX|CPP|LD)FLAGS$|CMAKE_|PYTHON(?!PATH$)|NINJA_")
"""Names of variables that belong to the caller's builds and programs.  PYTHONPATH names the packages of the tests."""

# Programs that tests start do not depend on the environment of the caller.  GNU make, for example, tells each make that
# the tests start to show no commands, and CMake to colour its output, also into a pipe.
for name in list(filter(_OTHERS.match, os.environ)):
    del os.environ[name]
share_objects(os.environ)


_cpu: dict[str, float] = defaultdict(float)
"""CPU seconds of each test, with its fixtures."""


def _cpu_seconds() -> float:
    """User and system time of this process and of all its children that have ended."""
    return sum(os.times()[:4])


@pytest.hookimpl(wrapper=True)
def pytest_runtest_protocol(item: pytest.Item) -> Iterator[None]:
    """Measures the CPU time of a test."""
    began = _cpu_seconds()
    try:
        return (yield)
    finally:
        _cpu[item.nodeid] += _cpu_seconds() - began


@pytest.hookimpl(tryfirst=True)
def pytest_runtest_setup() -> None:
    """Skips a test if the time of tests/run.py is over: then the file that ``EPG_TESTS_OVER`` names exists."""
    if os.path.exists(os.environ.get("EPG_TESTS_OVER", "")):
        pytest.skip("the time of this run is over")


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Marks every test with its tier: ``-m check_all`` then selects that tier.

    Where whole files are collected, each line of tests/tiers.txt that names a test in them must name one that exists.
    """
    tiers = table()
    if not any("::" in argument for argument in config.args):
        for path in unused(tiers, [item.nodeid for item in items]):
            raise pytest.UsageError(f"tests/tiers.txt: there is no such test: {path}")
    for item in items:
        item.add_marker(tiers.tier(item.nodeid))
    prefer({item.nodeid.partition("::")[0] for item in items}, tiers)


def prefer(files: set[str], tiers: Table) -> None:
    """Gives this process a better priority if all ``files`` run in real time, and if the user may do so.

    All programs that the tests start inherit it: targets, servers, browsers.
    """
    if files and files <= tiers.real_time and hasattr(os, "setpriority"):
        with contextlib.suppress(PermissionError):
            os.setpriority(os.PRIO_PROCESS, 0, PRIORITY)


@pytest.hookimpl(trylast=True)
def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter, exitstatus: int) -> None:
    """Reports to ctest if every test was skipped, and appends all outcomes to the file that ``EPG_TEST_LOG`` names."""
    seconds: dict[str, float] = defaultdict(float)
    skipped: dict[str, str] = {}
    failed = set()
    for outcome, reports in terminalreporter.stats.items():
        for report in reports:
            if not isinstance(report, (pytest.TestReport, pytest.CollectReport)):
                continue
            seconds[report.nodeid] += getattr(report, "duration", 0.0)
            if outcome in ("failed", "error"):
                failed.add(report.nodeid)
            if outcome == "skipped":
                reason = report.longrepr[2] if isinstance(report.longrepr, tuple) else str(report.longrepr)
                skipped[report.nodeid] = reason.removeprefix("Skipped: ")
    log = os.environ.get("EPG_TEST_LOG")
    if log and seconds:
        lines = [
            json.dumps(
                {
                    "test": test,
                    "seconds": round(duration, 3),
                    "cpu": round(_cpu[test], 3),
                    "skipped": skipped.get(test, ""),
                    "failed": test in failed,
                }
            )
            for test, duration in seconds.items()
        ]
        with open(log, "a", encoding="utf-8") as file:
            file.write("".join(f"{line}\n" for line in lines))
    if skipped and not terminalreporter.stats.get("passed") and exitstatus in (0, 5):
        terminalreporter.write_line(f"EPG: all {len(skipped)} tests were skipped")
