# SPDX-License-Identifier: Apache-2.0
"""Tries mutants, several at the same time."""

from __future__ import annotations

import time
from collections.abc import Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor, as_completed
from pathlib import Path
from queue import SimpleQueue

from .choice import Choice
from .runtime import Objects
from .workshop import Workshop

IN_PROCESS = [
    *(
        "tests/errors",
        "tests/documents",
        "tests/check",
        "tests/resolve",
        "tests/emit",
        "tests/runtime/test_templates.py",
    ),
    *("tests/catalog/test_builtin_catalog.py", "tests/catalog/test_wrong_catalog.py"),
    *("tests/cli/test_commands.py", "tests/cli/test_schema.py", "tests/connect/test_view.py"),
]
"""Tests that call EPG in their own process."""
CLOSED_LOOP = ["tests/runtime/test_faulty_robot.py"]
"""Tests that start EPG as a user does.

They run last, for mutants in the areas :data:`RUNS` that survive the others.
"""
RUNS = ("emit", "runtime")


class Trial:
    """Copies of the project in ``folder``, one for each of ``jobs`` threads."""

    def __init__(self, folder: Path, jobs: int, at_most: float) -> None:
        """``at_most`` limits the seconds of tests for one mutant of Python."""
        self._folder = folder
        self._jobs = jobs
        self._at_most = at_most
        self._free: SimpleQueue[Workshop] = SimpleQueue()

    def run(self, chosen: Sequence[Choice]) -> Iterator[tuple[Choice, bool]]:
        """Each mutant, and True if a test catches it, in any order."""
        workshops = []
        began = time.monotonic()
        for number in range(self._jobs):
            copy = self._folder / f"copy{number}"
            copy.mkdir()
            workshops.append(Workshop(copy, IN_PROCESS))
            self._free.put(workshops[-1])
        with ThreadPoolExecutor(self._jobs) as pool:
            parts = pool.map(lambda k: workshops[k].record(k, self._jobs), range(self._jobs))
            self._coverage = {test: found for part in parts for test, found in part.items()}
        minutes = (time.monotonic() - began) / 60
        print(f"{len(self._coverage)} tests without a mutant: {minutes:.0f} minutes", flush=True)
        self._objects = Objects(self._folder / "objects")
        with ThreadPoolExecutor(self._jobs) as pool:
            trials = {pool.submit(self._try, one): one for one in chosen}
            for trial in as_completed(trials):
                yield trials[trial], trial.result()
        for workshop in workshops:
            workshop.close()

    def _try(self, one: Choice) -> bool:
        workshop = self._free.get()
        try:
            if one.mutant.file.endswith(".c"):
                caught = self._objects.catch(one.mutant, workshop.folder)
            else:
                caught = workshop.catches(one.mutant, self._coverage, self._at_most)
            return caught or (one.area in RUNS and workshop.catches_last(one.mutant, CLOSED_LOOP))
        finally:
            self._free.put(workshop)
