#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Statistics of round-trip times, as a table.

    python summary.py runs/*.csv

prints one row for each file that measure.py wrote.  The deviation is that of the mean from the smallest mean of the
table, in per cent.
"""

from __future__ import annotations

import argparse
import math
import statistics
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

PERCENTILES = (90.0, 99.0, 99.9)


@dataclass(frozen=True)
class Run:
    """Round-trip times in s, in the order of the pings, and how many pings were never answered."""

    label: str
    times: Sequence[float]
    lost: int


@dataclass(frozen=True)
class Summary:
    """Times in s."""

    label: str
    count: int
    lost: int
    mean: float
    deviation: float
    minimum: float
    maximum: float
    median: float
    percentiles: tuple[float, ...]


def summarise(run: Run) -> Summary:
    """The standard deviation is that of a sample (n - 1)."""
    times = sorted(run.times)
    if not times:
        nothing = math.nan
        return Summary(run.label, 0, run.lost, *[nothing] * 5, tuple(nothing for _ in PERCENTILES))
    return Summary(
        run.label,
        len(times),
        run.lost,
        statistics.fmean(times),
        statistics.stdev(times) if len(times) > 1 else 0.0,
        times[0],
        times[-1],
        statistics.median(times),
        tuple(percentile(times, p) for p in PERCENTILES),
    )


def percentile(ordered: Sequence[float], p: float) -> float:
    """The least of the values that ``p`` per cent of all do not exceed (nearest rank): one that was measured."""
    return ordered[max(0, math.ceil(p / 100.0 * len(ordered)) - 1)]


def head() -> list[str]:
    return [
        "",
        "count",
        "lost",
        "mean (ms)",
        "standard deviation (ms)",
        "deviation of mean (%)",
        "min (ms)",
        "max (ms)",
        "median (ms)",
        *(f"{p:g} % (ms)" for p in PERCENTILES),
    ]


def rows(summaries: Sequence[Summary]) -> list[list[str]]:
    """The cells of a table, a row for each summary."""
    means = [s.mean for s in summaries if not math.isnan(s.mean)]
    least = min(means) if means else math.nan
    return [
        [
            s.label,
            str(s.count),
            str(s.lost),
            _ms(s.mean),
            _ms(s.deviation),
            f"{100.0 * (s.mean / least - 1.0):.2f}",
            _ms(s.minimum),
            _ms(s.maximum),
            _ms(s.median),
            *(_ms(p) for p in s.percentiles),
        ]
        for s in summaries
    ]


def table(summaries: Sequence[Summary]) -> str:
    """For the terminal."""
    cells = [head(), *rows(summaries)]
    widths = [max(len(row[column]) for row in cells) for column in range(len(cells[0]))]
    return "\n".join(
        "  ".join([row[0].ljust(widths[0]), *(cell.rjust(width) for cell, width in zip(row[1:], widths[1:]))]).rstrip()
        for row in cells
    )


def _ms(seconds: float) -> str:
    return f"{1e3 * seconds:.3f}"


def write_run(run: Run, path: Path) -> None:
    """Two lines of comment, then one round-trip time in s per line."""
    with path.open("w", encoding="utf-8", newline="\n") as file:
        file.write(f"# {run.label}\n# lost {run.lost}\n")
        file.writelines(f"{time:.9f}\n" for time in run.times)


def read_run(path: Path) -> Run:
    lines = path.read_text(encoding="utf-8").splitlines()
    if len(lines) < 2 or not lines[0].startswith("# ") or not lines[1].startswith("# lost "):
        raise ValueError(f"{path}: measure.py did not write this file")
    return Run(lines[0][2:], [float(line) for line in lines[2:]], int(lines[1].removeprefix("# lost ")))


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("runs", nargs="+", type=Path, metavar="FILE", help="what measure.py wrote")
    try:
        print(table([summarise(read_run(path)) for path in parser.parse_args().runs]))
    except (OSError, ValueError) as error:
        print(error, file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
