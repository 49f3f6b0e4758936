# SPDX-License-Identifier: Apache-2.0
"""Runs the simulation with random faults: no two parts may meet, no block may be lost, and blocks must go round.

    python random_faults.py build/production_cell --runs 10000

In each run, five times a machine loses its power, hangs until its watchdog resets it, or is cut off from the network.
The faults of a run follow from its number, which is also the seed of the simulation.
"""

from __future__ import annotations

import argparse
import json
import os
import random
import subprocess
import sys
import tempfile
from collections import Counter
from collections.abc import Iterable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

MACHINES = ("feeder_belt", "feeder", "door", "extractor", "extraction_belt", "robot")
CHECKS = (  # cell_fault_t in plant/cell.h
    "none",
    "blocks overlap",
    "the feeder belt runs with the feeder",
    "the feeder belt runs with the robot",
    "the extraction belt runs with the extractor",
    "the extraction belt runs with the robot",
    "the door is on the extractor",
    "the feeder meets the extractor",
    "the feeder pushes at the open door",
    "a block is jammed",
)
FAULTS = 5
FIRST, LAST = 1.0, 9.0  # s: when they begin
WATCHDOG = 0.1  # s, of all boards
LONGEST_DEATH, LONGEST_SILENCE = 3.0, 6.0  # s
DURATION = 36.0  # s: with all faults over after 15 s, each machine has time to go on
QUIET = 15.0  # s: a block must have been moulded in this time at the end of a run


def faults(number: int) -> list[tuple[float, str, str]]:
    """The events of a run: time, machine and event, in the order of time."""
    chance = random.Random(number)
    events = []
    for _ in range(FAULTS):
        time, machine = chance.uniform(FIRST, LAST), chance.choice(MACHINES)
        fault, end, duration = chance.choice(
            [
                ("die", "restart", LONGEST_DEATH * chance.random() ** 2),
                ("hang", "restart", WATCHDOG),
                ("offline", "online", chance.uniform(0.1, LONGEST_SILENCE)),
            ]
        )
        events += [(time, machine, fault), (time + duration, machine, end)]
    return sorted(events)


def run(program: Path, events: Iterable[tuple[float, str, str]], duration: float, seed: int = 0) -> dict[str, float]:
    """The last outputs of the plant in a run with these events."""
    with tempfile.TemporaryDirectory() as folder:
        file, result = Path(folder, "events.csv"), Path(folder, "statistics.json")
        lines = [f"{time:.6f},{machine},{event}\n" for time, machine, event in events]
        file.write_text("time,target,event\n" + "".join(lines), encoding="utf-8")
        command = [program, "--duration", str(duration), "--events", file, "--seed", str(seed), "--statistics", result]
        subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
        outputs: dict[str, float] = json.loads(result.read_text(encoding="utf-8"))["plant"]
        return outputs


def verdict(end: dict[str, float]) -> str:
    """What is wrong at the end of a run with random faults; nothing: an empty text."""
    if end["collisions"] > 0:
        return f"two parts in one space: {CHECKS[int(end['first_collision'])]}"
    if end["lost"] > 0:
        return "a block is lost"
    return "" if end["last_moulded"] > DURATION - QUIET else "the blocks stand still"


def verdicts(program: Path, numbers: Iterable[int]) -> dict[int, str]:
    """The verdict of each run."""
    numbers = list(numbers)
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        ends = pool.map(lambda number: run(program, faults(number), DURATION, number), numbers)
        return {number: verdict(end) for number, end in zip(numbers, ends, strict=True)}


def main() -> int:
    parser = argparse.ArgumentParser(description="runs the production cell with random faults")
    parser.add_argument("program", type=Path, help="the program of the simulation")
    parser.add_argument("--runs", type=int, default=200)
    parser.add_argument("--first", type=int, default=0, help="number of the first run")
    arguments = parser.parse_args()
    program = arguments.program.resolve()
    bad = {
        n: text
        for n, text in verdicts(program, range(arguments.first, arguments.first + arguments.runs)).items()
        if text
    }
    for text, count in sorted(Counter(bad.values()).items()):
        print(f"{count} runs: {text}; the first is run {min(n for n in bad if bad[n] == text)}")
    print(f"{arguments.runs} runs with {FAULTS} faults each, {len(bad)} bad ones")
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
