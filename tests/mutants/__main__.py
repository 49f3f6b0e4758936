# SPDX-License-Identifier: Apache-2.0
"""Tries mutants of the generator and the runtime against the tests.

Two commands are common::

    python -m tests.mutants --check     # fails if a mutant that was caught before now survives
    python -m tests.mutants --choose    # tries 200 mutants that tests/mutants/caught.txt does not list
"""

from __future__ import annotations

import argparse
import sys
import tempfile
import time
from pathlib import Path

from . import results
from .choice import AREAS, Choice, all_mutants, choose, find
from .results import CAUGHT, SURVIVED, Result
from .trial import Trial
from .workshop import ALL, SOME

RESULTS = Path(__file__).resolve().parent / "caught.txt"


def main(arguments: list[str]) -> int:
    parser = argparse.ArgumentParser(prog="python -m tests.mutants", description=(__doc__ or "").partition("\n")[0])
    task = parser.add_mutually_exclusive_group(required=True)
    task.add_argument("--check", action="store_true", help="try the mutants of the file of results again")
    task.add_argument("--choose", action="store_true", help="choose mutants and add them to the file of results")
    parser.add_argument("--results", type=Path, default=RESULTS, help="the file of results")
    parser.add_argument("--each", type=int, default=50, help="how many mutants to choose in each of the four areas")
    parser.add_argument("--seed", type=int, default=1, help="another number chooses other mutants")
    parser.add_argument("--jobs", type=int, default=2, help="how many mutants are tried at the same time")
    options = parser.parse_args(arguments)
    began = time.monotonic()
    everything = all_mutants()
    with tempfile.TemporaryDirectory(prefix="epg-mutants-") as folder:
        if options.choose:
            status = _choose(options, everything, Path(folder))
        else:
            status = _check(options, everything, Path(folder))
    print(f"{(time.monotonic() - began) / 60:.0f} minutes")
    return status


def _choose(options: argparse.Namespace, everything: list[Choice], folder: Path) -> int:
    chosen = [one for area in AREAS for one in choose(everything, area, options.each, options.seed, folder)]
    found = results.read(options.results) if options.results.is_file() else []
    known = {result.identity for result in found}
    rest = [one for one in chosen if one.mutant.identity not in known]
    for one, caught in Trial(folder, options.jobs, SOME).run(rest):
        found.append(Result(CAUGHT if caught else SURVIVED, one.area, one.mutant.identity))
        _show(found[-1].state, found[-1], one)
        results.write(options.results, found)
    for state in results.STATES:
        print(f"{state}: {sum(result.state == state for result in found)}")
    return 0


def _check(options: argparse.Namespace, everything: list[Choice], folder: Path) -> int:
    """Tries the mutants that were caught before, with all tests: which tests are the quickest varies between runs."""
    before = [result for result in results.read(options.results) if result.state == CAUGHT]
    results_of = {one: result for result in before for one in find(everything, result.identity)}
    for result in before:
        if result not in results_of.values():
            _show("gone", result)
    survived = set()
    for one, caught in Trial(folder, options.jobs, ALL).run(list(results_of)):
        if not caught:
            survived.add(results_of[one])
            _show(SURVIVED, results_of[one], one)
    found = len(set(results_of.values()))
    print(f"{found - len(survived)} are still caught, {len(survived)} survive, {len(before) - found} are gone")
    return 1 if survived else 0


def _show(state: str, result: Result, one: Choice | None = None) -> None:
    place = f" {one.mutant.file}:{one.mutant.lines.start}" if one else ""
    found = result.identity
    print(f"{state}: {result.area} {found.function}{place}\n  - {found.before}\n  + {found.after}", flush=True)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
