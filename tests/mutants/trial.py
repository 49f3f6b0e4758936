# SPDX-License-Identifier: Apache-2.0
"""Runs the tests of a room in a copy of the project with a mutant."""

from __future__ import annotations

import os
import re
import shutil
import signal
import subprocess
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

from epg.generator.bootstrap import cache_folder
from tests.checkout import ROOT, listed

from .record import NONE, NOT_TRIED, Mutant

LIMIT = 600
"""Seconds after which tests count as endless, which is a failure of the first one."""
_FAILED = re.compile(r"^(?:FAILED|ERROR) (.*?)(?: - .*)?$", re.MULTILINE)
_PASSED = re.compile(r"\b[1-9]\d* passed\b")


class Copy:
    """A copy of the project in ``folder``; used by one thread."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._tree = folder / "epg"
        self._stamp = folder.stat().st_mtime
        for name in listed("--cached", "--others", "--exclude-standard"):
            (self._tree / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy2(ROOT / name, self._tree / name)
        self._environment = _environment(folder)
        self._sound: set[str] = set()
        self._broken: set[str] = set()

    def state_of(self, mutant: Mutant, tests: Sequence[str]) -> str:
        """The test that notices a mutant and passes without it, or ``none``, or ``not tried`` if all are skipped.

        The test that noticed it before runs first, then all tests of its room.
        """
        state = self._noticed_by(mutant, [mutant.test]) if mutant.test else NONE
        return self._noticed_by(mutant, tests) if state in (NONE, NOT_TRIED) else state

    def _noticed_by(self, mutant: Mutant, tests: Sequence[str]) -> str:
        while True:
            left_out = sorted(self._broken)
            with self._mutated(mutant):
                state = self._run([*tests, *(f"--deselect={test}" for test in left_out)])
            if state in (NONE, NOT_TRIED) or self._is_sound(state):
                return state
            if state in left_out:
                return NOT_TRIED

    def _is_sound(self, test: str) -> bool:
        """True if a test passes without a mutant."""
        if test not in self._sound | self._broken:
            found = self._run([test])
            (self._sound if found == NONE else self._broken).add(test)
        return test in self._sound

    def _run(self, tests: Sequence[str]) -> str:
        """The first test that fails, or ``none``, or ``not tried`` if no test ran."""
        options = ["-q", "-x", "--tb=no", "--no-header", "-p", "no:cacheprovider", "-m", "check or check_all"]
        process = subprocess.Popen(
            [sys.executable, "-m", "pytest", *options, "--basetemp", str(self._folder / "tests"), *tests],
            cwd=self._tree,
            env=self._environment,
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            text=True,
            start_new_session=True,
        )
        try:
            printed, _ = process.communicate(timeout=LIMIT)
        except subprocess.TimeoutExpired:
            os.killpg(process.pid, signal.SIGKILL)
            process.communicate()
            return tests[0]
        # 4 says that a test of the record has another name now, and 5 that there are no tests.
        if process.returncode in (0, 4, 5):
            return NONE if _PASSED.search(printed) else NOT_TRIED
        found = _FAILED.search(printed)
        return found[1] if found else tests[0]

    @contextmanager
    def _mutated(self, mutant: Mutant) -> Iterator[None]:
        path = self._tree / mutant.file
        original = path.read_text(encoding="utf-8")
        self._write(path, original.replace(mutant.before, mutant.after))
        try:
            yield
        finally:
            self._write(path, original)

    def _write(self, path: Path, text: str) -> None:
        """Writes a file with a new time stamp, by which Python, Jinja and CMake see that it has changed."""
        path.write_text(text, encoding="utf-8")
        self._stamp += 2
        os.utime(path, (self._stamp, self._stamp))


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
