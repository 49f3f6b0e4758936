# SPDX-License-Identifier: Apache-2.0
"""Renews the record of mutants, or checks it."""

from __future__ import annotations

import argparse
import itertools
import random
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor, as_completed
from dataclasses import replace
from pathlib import Path
from queue import SimpleQueue

from tests.checkout import ROOT
from tests.size.measure import files

from . import record
from .draw import SUFFIXES, compiles, mutants
from .record import NONE, Mutant
from .trial import Copy

NOT_DRAWN = {"tests", "docs"}
"""Folders."""


def main(arguments: list[str]) -> int:
    parser = argparse.ArgumentParser(prog=record.COMMAND, description=__doc__)
    task = parser.add_mutually_exclusive_group()
    task.add_argument("--mend", action="store_true", help="only replace mutants that do not apply")
    task.add_argument("--check", action="store_true", help="try the mutants that were noticed, and write nothing")
    task.add_argument("--report", action="store_true", help="print the age; fail if a mutant does not apply")
    parser.add_argument("--each", type=int, default=3, help="how many mutants each room must have")
    parser.add_argument("--seed", type=int, default=1, help="another number draws other mutants")
    parser.add_argument("--minutes", type=float, default=18, help="begin no mutant after this time")
    parser.add_argument("--jobs", type=int, default=2, help="how many mutants are tried at the same time")
    options = parser.parse_args(arguments)
    known = record.read()
    if options.report:
        old = record.age()
        print(record.summary(known, old))
        wrong = list(record.problems(known, old))
        print("".join(f"  {problem}\n" for problem in wrong), end="")
        return 1 if wrong else 0
    kept, chosen = _chosen(options, known)
    end = time.monotonic() + 60 * options.minutes  # the user's limit
    with tempfile.TemporaryDirectory(prefix="epg-mutants-") as folder:
        states = try_all(chosen, Path(folder), options.jobs, end)
    tried = [replace(one, state=states.get(one, one.state)) for one in chosen]
    lost = [one for one in chosen if one.kind == "noticed" and states.get(one) == NONE]
    for one in lost:
        print(f"lost: {one.file}: no test notices this any more\n  - {one.before}\n  + {one.after}")
    late = Counter(one.kind for one in chosen if one not in states)
    if not options.check:
        record.write([*kept, *tried])
        if not late["noticed"] and not options.mend:  # the others are tried as far as there is time
            record.renewed()
    print(record.summary([*kept, *tried], record.age()))
    print("late: " + (", ".join(f"{count} {kind}" for kind, count in sorted(late.items())) or "none"))
    return 1 if lost else 0


def _chosen(options: argparse.Namespace, known: Sequence[Mutant]) -> tuple[list[Mutant], list[Mutant]]:
    """The mutants that are kept as they are, and those to try: those that need all tests of their room come last."""
    applying = []
    for one in known:
        if moved := _moved(one):
            applying.append(moved)
        else:
            print(f"gone: {one.problem()}")
    if options.check:
        return [one for one in applying if one.kind != "noticed"], [one for one in applying if one.kind == "noticed"]
    drawn = draw(applying, record.rooms(), options.each, options.seed)
    if options.mend:
        return applying, drawn
    again = [one for one in applying if one.kind != "equivalent"]
    again.sort(key=lambda one: 0 if one.test else 1 + (one.kind == NONE))
    tested = sum(bool(one.test) for one in again)
    kept = [one for one in applying if one.kind == "equivalent"]
    return kept, [*again[:tested], *drawn, *again[tested:]]


def _moved(mutant: Mutant) -> Mutant | None:
    """The mutant where it applies: in its file, or in the only other file of the same name with its text."""
    if not mutant.problem():
        return mutant
    name = Path(mutant.file).name
    others = [replace(mutant, file=file) for file in files() if Path(file).name == name]
    found = [one for one in others if not one.problem()]
    return found[0] if len(found) == 1 and not (ROOT / mutant.file).is_file() else None


def sources() -> list[str]:
    """The files from which mutants are drawn."""
    return [file for file in files() if Path(file).suffix in SUFFIXES and NOT_DRAWN.isdisjoint(file.split("/"))]


def draw(known: Iterable[Mutant], rooms: Mapping[str, Sequence[str]], each: int, seed: int) -> list[Mutant]:
    """As many new mutants as each room lacks, one of each room after the other.  At first, files have at most one."""
    places: dict[str, list[str]] = {room: [] for room in rooms}
    for file in sources():
        if room := record.room_of(file, rooms):
            places[room].append(file)
    have = Counter(record.room_of(one.file, rooms) for one in known)
    lines = {(one.file, one.before) for one in known}
    drawn = []
    for room, some in places.items():
        chance = random.Random(f"{seed} {room}")
        made = sorted(_in_some_order(some, chance) if have[room] < each else [], key=lambda entry: entry[0])
        new = (one for _, one in made if (one.file, one.before) not in lines and _is_correct(one))
        drawn += list(enumerate(itertools.islice(new, max(0, each - have[room]))))
    return [one for _, one in sorted(drawn, key=lambda entry: entry[0])]


def _in_some_order(names: Sequence[str], chance: random.Random) -> Iterator[tuple[int, Mutant]]:
    """The mutants of files, each with its number in its file."""
    for file in chance.sample(names, len(names)):
        made = list(mutants((ROOT / file).read_text(encoding="utf-8"), Path(file).suffix))
        yield from enumerate(Mutant(file, *texts) for texts in chance.sample(made, len(made)))


def _is_correct(mutant: Mutant) -> bool:
    source = (ROOT / mutant.file).read_text(encoding="utf-8")
    return compiles(source.replace(mutant.before, mutant.after), Path(mutant.file).suffix)


def try_all(chosen: Sequence[Mutant], folder: Path, jobs: int, end: float) -> dict[Mutant, str]:
    """The new state of each mutant.  Those that would begin after ``end`` are left out."""
    rooms = record.rooms()
    free: SimpleQueue[Copy] = SimpleQueue()
    for number in range(jobs):
        (folder / f"{number}").mkdir()
        free.put(Copy(folder / f"{number}"))

    def state_of(one: Mutant) -> str | None:
        copy = free.get()
        try:
            room = record.room_of(one.file, rooms)
            return copy.state_of(one, rooms[room]) if room and time.monotonic() < end else None  # the user's limit
        finally:
            free.put(copy)

    states = {}
    pool = ThreadPoolExecutor(jobs)
    try:
        trials = {pool.submit(state_of, one): one for one in chosen}
        for trial in as_completed(trials):
            one, state = trials[trial], trial.result()
            if state is not None:
                states[one] = state
                print(f"{one.file}: {state}\n  - {one.before}\n  + {one.after}", flush=True)
    except KeyboardInterrupt:
        print("waiting for the mutants that have begun", flush=True)
    finally:
        pool.shutdown(cancel_futures=True)
    return states


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
