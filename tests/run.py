# SPDX-License-Identifier: Apache-2.0
"""Runs a tier of EPG's tests with ctest, then lists the skipped, the slowest and the failed tests.

The targets ``check``, ``check_all`` and ``check_long`` start it::

    python tests/run.py check --build build/tests
    EPG_EXPECTED_SKIPS=tests/expected_skips.txt python tests/run.py check_all --build build/tests

It also runs tests alone, with the packages that the targets use::

    python tests/run.py "tests/cli/test_doctor.py::test_it_ends"

``check_all`` also runs the tests of ``check``.  Exit code 0 means that every test passed or was skipped.  If the
environment variable ``EPG_EXPECTED_SKIPS`` names a file, that file must also list every reason for a skip.  After
``EPG_TEST_MINUTES`` minutes, tests that have not begun are skipped.
``--write-costs tests/costs.txt`` records the CPU time of each file.  Later runs use it to order and group the files.
"""

from __future__ import annotations

import argparse
import json
import os
import queue
import re
import shlex
import subprocess
import sys
import threading
import time
from collections import Counter, defaultdict
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))

from epg.generator.bootstrap import package_folder
from tests.tiers import all_groups, read_costs, table, text_of

ROOT = Path(__file__).resolve().parent.parent
LABELS = {"check": "^check$", "check_all": "^check(_all)?$", "check_long": "^check_long$"}
SLOWEST = 10
WORTH_TELLING = 10.0
"""Limit in CPU seconds: a difference to tests/costs.txt below it is not reported."""
BEGINNING = "*: "
SILENCE = 20.0
"""Seconds without a line after which the running tests are named."""


@dataclass(frozen=True)
class Outcome:
    """One test as tests/hooks.py logged it."""

    test: str
    seconds: float
    """Wall time."""
    skipped: str
    """The reason why the test was skipped; empty if it ran."""
    failed: bool = False
    cpu: float = 0.0
    """CPU time in seconds, with the child processes."""


class Progress:
    """Passes the output of ctest on, and says what runs if nothing has been printed for some time."""

    def __init__(self) -> None:
        self._began = time.monotonic()  # it is printed
        self._running: dict[str, str] = {}
        self.ran = 0
        """How many tests of ctest have ended."""
        self.failed: list[str] = []
        """The tests of ctest that did not pass."""

    def follow(self, lines: Iterable[str], silence: float = SILENCE) -> Iterator[str]:
        """Yields the ``lines``, and a line of its own after each ``silence`` in seconds."""
        arrived: queue.SimpleQueue[str | None] = queue.SimpleQueue()

        def read() -> None:
            for line in lines:
                arrived.put(line)
            arrived.put(None)

        threading.Thread(target=read, daemon=True).start()
        while True:
            try:
                line = arrived.get(timeout=silence)
            except queue.Empty:
                yield f"        after {self.took()}: {', '.join(self._running.values())} ...\n"
                continue
            if line is None:
                return
            self._read(line)
            yield line

    def took(self) -> str:
        """The time since its begin."""
        return "{} min {} s".format(*divmod(round(time.monotonic() - self._began), 60))  # it is printed

    def _read(self, line: str) -> None:
        if started := re.match(r" *Start +(\d+): (\S+)", line):
            self._running[started[1]] = started[2]
        elif ended := re.match(r" *\d+/\d+ Test +#(\d+): (\S+) \.*(.*)", line):
            self._running.pop(ended[1], None)
            self.ran += 1
            if not re.match(r" *(Passed|\*\*\*Skipped)", ended[3]):
                self.failed.append(ended[2])


def main(arguments: list[str]) -> int:
    options = _parse(arguments)
    if options.tier not in LABELS:
        return _run_alone(options.tier)
    log = options.build / "outcomes.jsonl"
    log.unlink(missing_ok=True)
    over = (options.build / "over").resolve()
    over.unlink(missing_ok=True)
    environment = {**os.environ, "EPG_TEST_LOG": str(log), "EPG_TESTS_OVER": str(over)}
    if minutes := os.environ.get("EPG_TEST_MINUTES"):
        timer = threading.Timer(60 * float(minutes), over.touch)
        timer.daemon = True
        timer.start()
    command = [options.ctest, "--output-on-failure", "--parallel", str(options.jobs), "--no-tests=error"]
    command += ["--label-regex", LABELS[options.tier]]
    progress = Progress()
    with subprocess.Popen(
        command, cwd=options.build, env=environment, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
        encoding="utf-8", errors="replace",
    ) as ctest:  # fmt: skip
        assert ctest.stdout is not None
        for line in progress.follow(ctest.stdout):
            print(line, end="", flush=True)
    outcomes = read_log(log)
    print(report(outcomes))
    committed = read_costs(text_of("costs.txt"))
    for line in wrong_costs(costs(outcomes), committed):
        print(line)
    if options.write_costs:
        options.write_costs.write_text(costs_text(costs(outcomes), committed), encoding="utf-8")
    expected = os.environ.get("EPG_EXPECTED_SKIPS")
    unexpected = unexpected_skips(outcomes, text_of(os.path.abspath(expected))) if expected else []
    for line in unexpected:
        print(f"unexpected skip: {line}")
    failed = failures(outcomes, progress.failed, options.build)
    if failed:
        print(f"{len(failed)} failed. Each command runs one alone:", *failed, sep="\n  ")
    print(f"{options.tier}: {summary(outcomes, progress.ran, len(failed))}, {progress.took()}")
    return ctest.returncode or bool(unexpected)


def _run_alone(test: str) -> int:
    """Runs a test of any tier, or all tests of a file or folder."""
    paths = [ROOT, package_folder("test_all"), package_folder("test"), os.environ.get("PYTHONPATH")]
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(str(path) for path in paths if path)}
    command = [sys.executable, "-m", "pytest", "-m", " or ".join(LABELS), test]
    return subprocess.run(command, cwd=ROOT, env=environment, check=False).returncode


def _parse(arguments: list[str]) -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("tier", help=f"{', '.join(LABELS)}; or a test that is to run alone")
    parser.add_argument(
        "--build", type=Path, default=Path("build/tests"), help="build folder in which the tests are configured"
    )
    parser.add_argument("--ctest", default="ctest", help="the program ctest")
    parser.add_argument("--jobs", type=int, default=2, help="how many test files run at the same time")
    parser.add_argument("--write-costs", type=Path, help="file for the measured CPU seconds")
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
        lines += [f"{outcome.seconds:6.1f} s ({outcome.cpu:.1f} s of CPU)  {outcome.test}" for outcome in slowest]
        lines.append("")
    return "\n".join(lines)


def summary(outcomes: list[Outcome], entries: int, failed: int) -> str:
    """The numbers of a run."""
    skipped = sum(bool(outcome.skipped) for outcome in outcomes)
    cpu = sum(outcome.cpu for outcome in outcomes)
    return (
        f"{entries} entries of ctest, {len(outcomes)} tests, {failed} failures, {skipped} skips, {cpu:.0f} CPU seconds"
    )


def failures(outcomes: list[Outcome], groups: list[str], build: Path) -> list[str]:
    """The commands that run each failed test alone.

    ``groups``: the tests of ctest that did not pass.  One that crashed or took too long has not logged its outcomes.
    """
    run = shlex.join([sys.executable, Path(__file__).resolve().relative_to(ROOT).as_posix()])
    failed = [outcome.test for outcome in outcomes if outcome.failed]
    files = {test.partition("::")[0] for test in failed}
    commands = [f"{run} {shlex.quote(test)}" for test in failed]
    for group in all_groups():
        if group.name in groups and files.isdisjoint(group.files):
            pattern = shlex.quote(f"^{re.escape(group.name)}$")
            commands.append(f"ctest --test-dir {shlex.quote(str(build))} --output-on-failure -R {pattern}")
    return commands


def costs(outcomes: list[Outcome]) -> dict[tuple[str, str], float]:
    """CPU seconds by tier and file."""
    result: dict[tuple[str, str], float] = defaultdict(float)
    tiers = table()
    for outcome in outcomes:
        result[tiers.tier(outcome.test), outcome.test.partition("::")[0]] += outcome.cpu
    return dict(result)


def costs_text(measured: Mapping[tuple[str, str], float], committed: Mapping[tuple[str, str], float]) -> str:
    """Text of tests/costs.txt: files that take a second or more, and the tiers that did not run as committed.

    A folder in ``integration`` has its own file, which is edited by hand.
    """
    ran = {tier for tier, _ in measured}
    seconds = {key: value for key, value in committed.items() if key[0] not in ran} | dict(measured)
    rows = [
        f"{tier:10s} {round(value):4d} {file}\n"
        for (tier, file), value in sorted(seconds.items())
        if value >= 1 and file.startswith("tests/")
    ]
    header = "# Measured CPU seconds per file: python tests/run.py check_all --write-costs tests/costs.txt\n"
    return header + "".join(rows)


def wrong_costs(measured: Mapping[tuple[str, str], float], committed: Mapping[tuple[str, str], float]) -> list[str]:
    """The entries of tests/costs.txt that are off by more than a factor of two, where both numbers matter."""
    lines = []
    for (tier, file), now in sorted(measured.items()):
        was = committed.get((tier, file), 0.0)
        if min(was, now) > WORTH_TELLING and max(was, now) > 2 * min(was, now):
            lines.append(f"tests/costs.txt: {tier} {file} took {now:.0f} CPU seconds, not {was:.0f}")
    return lines


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
