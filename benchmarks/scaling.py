# SPDX-License-Identifier: Apache-2.0
"""Measures the growth of EPG's time: 1000 components against 100 in one target, and 100 targets in one build.

The components are axes of :mod:`big_project`, on a chip with enough pins for them.  The table has the growth of the
whole time, and the growth without the start of Python: otherwise the start would hide growth that is worse than linear.
"""

from __future__ import annotations

import shutil
import statistics
import sys
import tempfile
import time
from collections.abc import Mapping
from functools import partial
from pathlib import Path

from big_project import BigProject, write_big_project
from measure import EPG, JIWY, ROOT, all_in_turns, in_turns, median_ratio, run
from report import Table, arguments, command_line, milliseconds, show

BORDER = 12.0
START = "epg --version"


def main() -> None:
    options = arguments(__doc__, rounds=9, components=1000, targets=100)
    with tempfile.TemporaryDirectory() as name:
        tables = [components_table(Path(name), options.components, options.rounds)]
        if shutil.which("cmake"):
            tables.append(targets_table(Path(name), options.targets, max(1, options.rounds // 3)))
    show("scaling", tables, options.write, command_line("scaling"))


# Components in one target ----------------------------------------------------------------------------------------


def components_table(folder: Path, largest: int, rounds: int) -> Table:
    """The times for 5 %, 10 %, 50 % and 100 % of ``largest`` components."""
    counts = sorted({4 * max(1, largest * share // 400) for share in (5, 10, 50, 100)})
    projects = {count: write_big_project(folder / f"big{count}", count) for count in counts}
    names = {count: f"{count} components" for count in counts}
    actions = {names[count]: partial(generate, project) for count, project in projects.items()}
    times = all_in_turns({START: lambda: run([sys.executable, EPG, "--version"]), **actions}, rounds)
    medians = {name: statistics.median(values) for name, values in times.items()}
    few = names[counts[-1] // 10 if counts[-1] // 10 in names else counts[0]]
    rows = [[START, milliseconds(medians[START]), "", ""]]
    for name in names.values():
        beyond = (medians[name] - medians[START]) / (medians[few] - medians[START])
        rows.append([name, milliseconds(medians[name]), f"{median_ratio(times, name, few):.1f} x", f"{beyond:.1f} x"])
    ratio = median_ratio(times, names[counts[-1]], few)
    judged = "holds" if ratio <= BORDER else "does not hold"
    note = f"Aim: {names[counts[-1]]} take at most {BORDER:g} x the time of {few}: {judged} ({ratio:.1f} x)."
    head = ["what", "ms", f"of {few}", "beyond the start"]
    return Table("Components in one target (epg generate, new folder)", head, rows, [note])


def generate(project: BigProject) -> None:
    output = project.folder / "output"
    shutil.rmtree(output, ignore_errors=True)
    run(
        [sys.executable, EPG, "generate", "big", *project.arguments, "--output", output],
        EPG_TARGETS_PATH=str(project.targets),
    )


# Targets in one build --------------------------------------------------------------------------------------------


def targets_table(folder: Path, largest: int, rounds: int) -> Table:
    """Configures projects with 10 %, 50 % and 100 % of ``largest`` targets, each in a new build folder."""
    counts = sorted({max(1, largest * share // 100) for share in (10, 50, 100)})
    for count in counts:
        write_targets_project(folder / f"targets{count}", count)
    names: Mapping[int, str] = {count: f"{count} targets" for count in counts}
    cold: dict[int, list[float]] = {count: [] for count in counts}
    for _ in range(rounds):
        for count in counts:
            shutil.rmtree(folder / f"targets{count}" / "build", ignore_errors=True)
            begin = time.perf_counter()
            configure(folder / f"targets{count}")
            cold[count].append(time.perf_counter() - begin)
    again = in_turns({names[count]: partial(configure, folder / f"targets{count}") for count in counts}, rounds)
    first = statistics.median(cold[counts[0]]) / counts[0]
    rows = []
    for count in counts:
        median = statistics.median(cold[count])
        each = milliseconds(median / count)
        growth = f"{median / count / first:.2f} x"
        rows.append([names[count], milliseconds(median), each, growth, milliseconds(again[names[count]] / count)])
    head = ["what", "ms", "ms for each", f"of {counts[0]} targets", "unchanged, ms for each"]
    return Table("Targets in one build (cmake, new folder)", head, rows)


def write_targets_project(folder: Path, count: int) -> None:
    folder.mkdir()
    model, bindings = (JIWY / "model").as_posix(), (JIWY / "jiwy.bindings.yaml").as_posix()
    lines = ["cmake_minimum_required(VERSION 3.22)", "project(many LANGUAGES C)", f'include("{epg_config()}")']
    for number in range(count):
        lines.append(f'epg_add_target(robot{number} TCF host_jiwy.tcf MODEL "{model}" BINDINGS "{bindings}")')
    (folder / "CMakeLists.txt").write_text("\n".join(lines) + "\n", encoding="utf-8")


def epg_config() -> str:
    return (ROOT / "cmake" / "EPGConfig.cmake").as_posix()


def configure(folder: Path) -> None:
    run(["cmake", "-S", folder, "-B", folder / "build", f"-DPython3_EXECUTABLE={sys.executable}"])


if __name__ == "__main__":
    main()
