# SPDX-License-Identifier: Apache-2.0
"""A copy of the project in a temporary folder, in which the tests run against one mutant after another."""

from __future__ import annotations

import json
import marshal
import os
import shutil
import signal
import subprocess
import sys
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path

from epg.bootstrap import cache_folder

from .mutant import Mutant

ROOT = Path(__file__).resolve().parents[2]
SOME = 6.0
"""Seconds of tests, the quickest first, for a mutant that is tried for the first time."""
ALL = float("inf")
LIMIT = 400
"""If a run of pytest takes longer than this, in seconds, the mutant counts as caught: the run is endless."""

Coverage = Mapping[str, tuple[float, Mapping[str, Sequence[int]]]]
"""Seconds and lines by file, for each test."""


class Workshop:
    """One copy; used by one thread."""

    def __init__(self, folder: Path, tests: Sequence[str]) -> None:
        """``tests`` call EPG in their own process: they are collected once."""
        self.folder = folder
        self.tree = folder / "epg"
        self._clock = 0
        _copy_project(self.tree)
        self._environment = _environment(folder)
        requests, self._requests = os.pipe()
        self._answers, answers = os.pipe()
        self._server = subprocess.Popen(
            [*self._pytest("server"), *tests],
            cwd=self.tree,
            env={**self._environment, "EPG_MUTANTS_PIPES": f"{requests} {answers}"},
            stdin=subprocess.DEVNULL,
            stdout=(folder / "server.log").open("w"),
            stderr=subprocess.STDOUT,
            pass_fds=(requests, answers),
        )
        os.close(requests)
        os.close(answers)
        self._from_server = os.fdopen(self._answers)

    def close(self) -> None:
        os.close(self._requests)
        self._from_server.close()
        self._server.wait()

    def record(self, part: int, parts: int) -> Coverage:
        """The lines that each test of a part of the files runs.  Tests that fail without a mutant are omitted."""
        path = self.folder / "record.json"
        self._ask({"record": str(path), "part": part, "parts": parts, "limit": 3600})
        found = json.loads(path.read_text("utf-8"))
        return {test: (seconds, lines) for test, (seconds, lines) in found.items()}

    def catches(self, mutant: Mutant, coverage: Coverage, at_most: float) -> bool:
        """True if a test fails that runs the line of a mutant of Python.  ``at_most`` limits the seconds of tests."""
        tests = tests_of(mutant, coverage, at_most)
        seconds = sum(coverage[test][0] for test in tests)
        if not tests:
            return False
        if mutant.at_import:
            with self._mutated(mutant.file, mutant.text()):
                return not self._passes(tests)
        code = self.folder / "code"
        code.write_bytes(marshal.dumps(compile(mutant.changed(), str(self.tree / mutant.file), "exec")))
        module = mutant.file.removesuffix(".py").removesuffix("/__init__").replace("/", ".")
        request = {"code": str(code), "module": module, "tests": tests, "limit": 30 + 5 * seconds}
        return not self._ask(request)

    def catches_last(self, mutant: Mutant, tests: Sequence[str]) -> bool:
        """True if a test fails, independent of the lines that it runs."""
        with self._mutated(mutant.file, mutant.text()):
            return not self._passes(tests)

    def _ask(self, request: Mapping[str, object]) -> bool:
        os.write(self._requests, f"{json.dumps(request)}\n".encode())
        answer = self._from_server.readline()
        assert answer, (self.folder / "server.log").read_text("utf-8")
        return bool(json.loads(answer))

    @contextmanager
    def _mutated(self, file: str, text: str) -> Iterator[None]:
        path = self.tree / file
        original = path.read_text(encoding="utf-8")
        self._write(path, text)
        try:
            yield
        finally:
            self._write(path, original)

    def _write(self, path: Path, text: str) -> None:
        """Writes a file with a new time stamp, by which Python and Ninja see that it has changed."""
        self._clock += 10
        path.write_text(text, encoding="utf-8")
        stamp = path.stat().st_mtime + self._clock
        os.utime(path, (stamp, stamp))

    def _passes(self, tests: Sequence[str]) -> bool:
        return run([*self._pytest("tests"), "-x", *tests], self.tree, self._environment, LIMIT) == 0

    def _pytest(self, name: str) -> list[str]:
        options = ["-q", "-p", "no:cacheprovider", "-p", "tests.mutants.server"]
        return [sys.executable, "-m", "pytest", *options, "--basetemp", str(self.folder / name)]


def run(command: Sequence[str | Path], folder: Path, environment: Mapping[str, str], limit: float) -> int:
    """The exit code of a program, or -1 if it was stopped with all its child processes after ``limit`` seconds."""
    process = subprocess.Popen(
        [str(part) for part in command],
        cwd=folder,
        env=dict(environment),
        stdin=subprocess.DEVNULL,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
        start_new_session=True,
    )
    try:
        return process.wait(limit)
    except subprocess.TimeoutExpired:
        os.killpg(process.pid, signal.SIGKILL)
        process.wait()
        return -1


def tests_of(mutant: Mutant, coverage: Coverage, at_most: float) -> list[str]:
    """The tests that run a mutant's line: first those of the file that is named after its module, then the quickest.

    All tests of that file, or at least one test; others while the sum of their times is at most ``at_most`` seconds.
    """
    own = f"/test_{Path(mutant.file).stem}.py::"
    tests = []
    for test, (seconds, lines) in coverage.items():
        found = lines.get(mutant.file, ())
        if found and (mutant.at_import or any(number in mutant.lines for number in found)):
            tests.append((own not in test, seconds, test))
    chosen: list[str] = []
    total = 0.0
    for other, seconds, test in sorted(tests):
        total += seconds
        if chosen and other and total > at_most:
            break
        chosen.append(test)
    return chosen


def _copy_project(folder: Path) -> None:
    command = ["git", "ls-files", "--cached", "--others", "--exclude-standard", "-z"]
    listed = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True).stdout
    for name in listed.split("\0"):
        if name and (ROOT / name).is_file():
            (folder / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy2(ROOT / name, folder / name)


def _environment(folder: Path) -> dict[str, str]:
    """The environment without variables of EPG, and with its own cache: a mutant may damage the templates there."""
    cache = folder / "cache"
    cache.mkdir()
    users = cache_folder()
    for entry in users.iterdir() if users.is_dir() else ():
        if not entry.name.startswith("templates-"):
            (cache / entry.name).symlink_to(entry)
    others = {name: value for name, value in os.environ.items() if not name.startswith("EPG_")}
    return {**others, "EPG_CACHE": str(cache)}
