# SPDX-License-Identifier: Apache-2.0
"""Runs a tier of EPG's tests with ctest, then lists the skipped tests and the slowest tests.

The targets ``check``, ``check_all`` and ``check_long`` start it::

    python tests/run.py check --build build/tests
    EPG_EXPECTED_SKIPS=tests/expected_skips.txt python tests/run.py check_all --build build/tests

``check_all`` also runs the tests of ``check``.  Exit code 0 means that every test passed or was skipped.  If the
environment variable ``EPG_EXPECTED_SKIPS`` names a file, that file must also list every reason for a skip.
``--write-costs tests/costs.txt`` records the time that each file took.  Later runs use it to order and group the files.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
import time
from collections import Counter, defaultdict
from dataclasses import dataclass
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))

from tests.tiers import table

LABELS = {"check": "^check$", "check_all": "^check(_all)?$", "check_long": "^check_long$"}
SLOWEST = 10
BEGINNING = "*: "


@dataclass(frozen=True)
class Outcome:
    """One test as tests/conftest.py logged it."""

    test: str
    seconds: float
    skipped: str
    """The reason why the test was skipped; empty if it ran."""


def main(arguments: list[str]) -> int:
    options = _parse(arguments)
    log = options.build / "outcomes.jsonl"
    log.unlink(missing_ok=True)
    began = time.monotonic()
    environment = {**os.environ, "EPG_TEST_LOG": str(log)}
    command = [options.ctest, "--output-on-failure", "--parallel", str(options.jobs), "--no-tests=error"]
    command += ["--label-regex", LABELS[options.tier]]
    status = subprocess.run(command, cwd=options.build, env=environment, check=False).returncode
    outcomes = read_log(log)
    print(report(outcomes))
    minutes, seconds = divmod(round(time.monotonic() - began), 60)
    print(f"{options.tier}: {len(outcomes)} tests in {minutes} min {seconds} s")
    if options.write_costs:
        options.write_costs.write_text(costs(outcomes), encoding="utf-8")
    expected = os.environ.get("EPG_EXPECTED_SKIPS")
    if expected:
        unexpected = unexpected_skips(outcomes, Path(expected).read_text(encoding="utf-8"))
        for line in unexpected:
            print(f"unexpected skip: {line}")
        if unexpected:
            return 1
    return status


def _parse(arguments: list[str]) -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("tier", choices=sorted(LABELS))
    parser.add_argument("--build", type=Path, required=True, help="build folder in which the tests are configured")
    parser.add_argument("--ctest", default="ctest", help="the program ctest")
    parser.add_argument("--jobs", type=int, default=2, help="how many test files run at the same time")
    parser.add_argument("--write-costs", type=Path, help="file for the measured seconds")
    return parser.parse_args(arguments)


def read_log(log: Path) -> list[Outcome]:
    """The tests that ran, in the order in which they ended."""
    if not log.is_file():
        return []
    return [Outcome(**json.loads(line)) for line in log.read_text(encoding="utf-8").splitlines()]


def report(outcomes: list[Outcome]) -> str:
    """Each reason for a skip once, and the slowest tests."""
    lines = [""]
    reasons = Counter(outcome.skipped for outcome in outcomes if outcome.skipped)
    if reasons:
        lines.append(f"{sum(reasons.values())} tests were skipped:")
        lines += [f"{count:5d}  {reason}" for reason, count in sorted(reasons.items())]
        lines.append("")
    ran = [outcome for outcome in outcomes if not outcome.skipped]
    slowest = sorted(ran, key=lambda outcome: (-outcome.seconds, outcome.test))[:SLOWEST]
    if slowest:
        lines.append("The slowest tests:")
        lines += [f"{outcome.seconds:6.1f} s  {outcome.test}" for outcome in slowest]
        lines.append("")
    return "\n".join(lines)


def costs(outcomes: list[Outcome]) -> str:
    """Lines ``tier seconds file`` for tests/costs.txt, for the files that take a second or more."""
    seconds: dict[tuple[str, str], float] = defaultdict(float)
    tiers = table()
    for outcome in outcomes:
        seconds[tiers.tier(outcome.test), outcome.test.partition("::")[0]] += outcome.seconds
    rows = [f"{tier:10s} {round(value):4d} {file}\n" for (tier, file), value in sorted(seconds.items()) if value >= 1]
    return "# Measured seconds per file: python tests/run.py check_all --write-costs tests/costs.txt\n" + "".join(rows)


def unexpected_skips(outcomes: list[Outcome], expected: str) -> list[str]:
    """The skipped tests, as ``test: reason``, that no line of ``expected`` allows.

    A line is the beginning of ``test: reason``, or ``*: `` and the beginning of a reason.  Empty lines and lines
    that begin with ``#`` are ignored.
    """
    lines = [line for line in expected.splitlines() if line and not line.startswith("#")]
    reasons = tuple(line.removeprefix(BEGINNING) for line in lines if line.startswith(BEGINNING))
    tests = tuple(line for line in lines if not line.startswith(BEGINNING))
    result = []
    for outcome in outcomes:
        skip = f"{outcome.test.partition('[')[0]}: {outcome.skipped}"
        if outcome.skipped and not outcome.skipped.startswith(reasons) and not skip.startswith(tests):
            result.append(skip)
    return result


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
