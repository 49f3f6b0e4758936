# SPDX-License-Identifier: Apache-2.0
"""Settings for all tests: EPG is on the module path, and every outcome is logged for tests/run.py."""

from __future__ import annotations

import json
import os
import sys
from collections import defaultdict
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT))

from tests.tiers import table  # noqa: E402


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Marks every test with its tier: ``-m check_all`` then selects that tier."""
    tiers = table()
    for item in items:
        item.add_marker(tiers.tier(item.nodeid))


@pytest.hookimpl(trylast=True)
def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter, exitstatus: int) -> None:
    """Reports to ctest if every test was skipped, and appends all outcomes to the file that ``EPG_TEST_LOG`` names."""
    seconds: dict[str, float] = defaultdict(float)
    skipped: dict[str, str] = {}
    for outcome, reports in terminalreporter.stats.items():
        for report in reports:
            if not isinstance(report, (pytest.TestReport, pytest.CollectReport)):
                continue
            seconds[report.nodeid] += getattr(report, "duration", 0.0)
            if outcome == "skipped":
                reason = report.longrepr[2] if isinstance(report.longrepr, tuple) else str(report.longrepr)
                skipped[report.nodeid] = reason.removeprefix("Skipped: ")
    log = os.environ.get("EPG_TEST_LOG")
    if log and seconds:
        lines = [
            json.dumps({"test": test, "seconds": round(duration, 3), "skipped": skipped.get(test, "")})
            for test, duration in seconds.items()
        ]
        with open(log, "a", encoding="utf-8") as file:
            file.write("".join(f"{line}\n" for line in lines))
    if skipped and not terminalreporter.stats.get("passed") and exitstatus in (0, 5):
        terminalreporter.write_line(f"EPG: all {len(skipped)} tests were skipped")
