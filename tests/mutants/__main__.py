# SPDX-License-Identifier: Apache-2.0
"""Tries mutants of the generator and the runtime against the tests::

python -m tests.mutants --check     # fails if a mutant that was caught before survives now
python -m tests.mutants --choose    # chooses 200 mutants anew, and writes tests/mutants/caught.txt
"""

from __future__ import annotations

import argparse
import sys
import tempfile
import time
from pathlib import Path

from . import results
from .choice import AREAS, Choice, all_mutants, choose, find
from .results import CAUGHT, EQUIVALENT, SURVIVED, Result
from .trial import Trial

RESULTS = Path(__file__).resolve().parent / "caught.txt"


def main(arguments: list[str]) -> int:
    parser = argparse.ArgumentParser(prog="python -m tests.mutants", description=(__doc__ or "").partition("\n")[0])
    task = parser.add_mutually_exclusive_group(required=True)
    task.add_argument("--check", action="store_true", help="try the mutants of the file of results again")
    task.add_argument("--choose", action="store_true", help="choose mutants and write the file of results")
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
    earlier = results.read(options.results) if options.results.is_file() else []
    equivalent = {result.identity: result for result in earlier if result.state == EQUIVALENT}
    found = []
    for one, caught in Trial(folder, options.jobs).run(chosen):
        result = Result(CAUGHT if caught else SURVIVED, one.area, one.mutant.identity)
        found.append(result if caught else equivalent.get(result.identity, result))
        _show(found[-1], one)
        results.write(options.results, found)
    for state in results.STATES:
        print(f"{state}: {sum(result.state == state for result in found)}")
    return 0


def _check(options: argparse.Namespace, everything: list[Choice], folder: Path) -> int:
    before = results.read(options.results)
    places = {result: find(everything, result.identity) for result in before if result.state != EQUIVALENT}
    result_of = {one: result for result, found in places.items() for one in found}
    now = {result: "gone" for result in before if result not in places or not places[result]}
    for one, caught in Trial(folder, options.jobs).run(list(result_of)):
        result = result_of[one]
        if now.get(result) != SURVIVED:
            now[result] = CAUGHT if caught else SURVIVED
        if now[result] != result.state:
            _show(Result(now[result], result.area, result.identity), one)
    for result in places:
        if now[result] == "gone":
            _show(Result("gone", result.area, result.identity))
    for state in results.STATES:
        counts = [sum(r.state == state and now[r] == other for r in places) for other in (CAUGHT, SURVIVED, "gone")]
        if state != EQUIVALENT:
            print(f"{state} before: {counts[0]} caught, {counts[1]} survive, {counts[2]} gone")
    return 1 if any(result.state == CAUGHT and now[result] == SURVIVED for result in places) else 0


def _show(result: Result, one: Choice | None = None) -> None:
    place = f" {one.mutant.file}:{one.mutant.lines.start}" if one else ""
    identity = result.identity
    print(
        f"{result.state}: {result.area} {identity.function}{place}\n  - {identity.before}\n  + {identity.after}",
        flush=True,
    )


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
