# SPDX-License-Identifier: Apache-2.0
"""Measures wall times for a comparison: the actions run in turns, so the load of the computer affects all of them.

A program that imports this module finds the packages ``epg`` and ``tests``, too.

>>> times = in_turns({"nothing": lambda: None, "sum": lambda: sum(range(1000))}, rounds=5)
>>> sorted(times)
['nothing', 'sum']
"""

from __future__ import annotations

import os
import statistics
import subprocess
import sys
import time
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
EPG = ROOT / "epg" / "__main__.py"
JIWY = ROOT / "examples" / "jiwy"
sys.path.insert(0, str(ROOT))


def need(*tools: Callable[[], object]) -> None:
    """Ends the program with a message if one of ``tools``, which search a tool for the tests, does not find it."""
    from tests.doubles.toolchain import Missing  # not at the top: other benchmarks run without the tests

    try:
        for tool in tools:
            tool()
    except Missing as missing:
        raise SystemExit(str(missing)) from None


def jiwy_files(tcf: str | Path) -> list[str]:
    """The arguments of ``epg`` for the files of JIWY."""
    return ["--tcf", str(tcf), "--model", str(JIWY / "model"), "--bindings", str(JIWY / "jiwy.bindings.yaml")]


def in_turns(actions: Mapping[str, Callable[[], object]], rounds: int) -> dict[str, float]:
    """Median wall time in seconds of each action.

    Every action runs once to warm caches.  Then ``rounds`` rounds are timed.  All actions run in each round, and each
    round begins with another action, so a computer that becomes slower affects all of them equally.
    """
    times = all_in_turns(actions, rounds)
    return {name: statistics.median(values) for name, values in times.items()}


def all_in_turns(actions: Mapping[str, Callable[[], object]], rounds: int) -> dict[str, list[float]]:
    """All times that :func:`in_turns` takes the median of, in seconds."""
    for action in actions.values():
        action()
    names = list(actions)
    times: dict[str, list[float]] = {name: [] for name in names}
    for number in range(rounds):
        first = number % len(names)
        for name in names[first:] + names[:first]:
            begin = time.perf_counter()
            actions[name]()
            times[name].append(time.perf_counter() - begin)
    return times


def median_ratio(times: Mapping[str, Sequence[float]], name: str, reference: str) -> float:
    """Median of the ratios of ``name`` to ``reference`` within the rounds: a slow moment affects both times."""
    return statistics.median(a / b for a, b in zip(times[name], times[reference]))


def run(command: Sequence[str | Path], **environment: str) -> str:
    """Runs a program, and returns its output.  Raises RuntimeError if it fails.

    Python programs always write and use ``.pyc`` files, even if the shell's environment forbids it: "cold" means a new
    output folder, not a new installation.
    """
    variables = {**os.environ, **environment}
    variables.pop("PYTHONDONTWRITEBYTECODE", None)
    done = subprocess.run([str(word) for word in command], env=variables, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise RuntimeError(f"{' '.join(map(str, command))}\n{done.stdout[-4000:]}\n{done.stderr[-4000:]}")
    return done.stdout
