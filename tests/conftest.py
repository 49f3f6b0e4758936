"""What all tests share: EPG on the module path, and skips that ctest and .ci/run can see."""

from __future__ import annotations

import os
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT))


@pytest.hookimpl(trylast=True)
def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter, exitstatus: int) -> None:
    """Says how many tests were skipped, for ctest, and writes which ones, for .ci/run."""
    skipped = terminalreporter.stats.get("skipped", [])
    log = os.environ.get("EPG_SKIP_LOG")
    if log and skipped:
        with open(log, "a", encoding="utf-8") as file:
            for report in skipped:
                reason = report.longrepr[2] if isinstance(report.longrepr, tuple) else str(report.longrepr)
                # Parameters of a test are any text: with ": " in them, nobody could tell where the reason begins.
                name = report.nodeid.partition("[")[0]
                file.write(f"{name}: {reason.removeprefix('Skipped: ')}\n")
    if skipped and exitstatus in (0, 5):
        terminalreporter.write_line(f"EPG: {len(skipped)} tests skipped")
