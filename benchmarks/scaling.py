# SPDX-License-Identifier: Apache-2.0
"""Measures the growth of EPG's time with the components of a target, the targets of a build, and those of a system.

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
SYSTEM_BORDER = 2.0
"""Seconds in which the largest system must be checked."""
START = "epg --version"


def main() -> None:
    options = arguments(__doc__, rounds=9, components=1000, targets=100, system=50)
    with tempfile.TemporaryDirectory() as name:
        tables = [components_table(Path(name), options.components, options.rounds)]
        tables.append(system_table(Path(name), options.system, options.rounds))
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


# Targets in one system -------------------------------------------------------------------------------------------


def system_table(folder: Path, largest: int, rounds: int) -> Table:
    """The times to check systems with 10 %, 50 % and 100 % of ``largest`` targets."""
    counts = sorted({max(2, largest * share // 100) for share in (10, 50, 100)})
    for count in counts:
        write_system(folder / f"{count}.system.yaml", count)
    names = {count: f"{count} targets" for count in counts}
    actions = {
        names[count]: partial(run, [sys.executable, EPG, "check", folder / f"{count}.system.yaml"]) for count in counts
    }
    times = all_in_turns({START: lambda: run([sys.executable, EPG, "--version"]), **actions}, rounds)
    rows = [
        [name, milliseconds(statistics.median(values)), f"{median_ratio(times, name, START):.1f} x"]
        for name, values in times.items()
    ]
    most = statistics.median(times[names[counts[-1]]])
    judged = "holds" if most <= SYSTEM_BORDER else "does not hold"
    note = f"Aim: {names[counts[-1]]} take at most {SYSTEM_BORDER:g} s: {judged} ({most:.1f} s)."
    return Table("Targets in one system (epg check)", ["what", "ms", f"of {START}"], rows, [note])


def write_system(path: Path, count: int) -> None:
    """A chain of JIWYs, each of which follows the one before it."""
    model, bindings = (JIWY / "model").as_posix(), (JIWY / "jiwy.bindings.yaml").as_posix()
    lines = ["version: 1", "system: chain", "targets:"]
    for number in range(count):
        board = ("rpi_pico_freertos", "rpi_pico2_bare_metal")[number % 2]
        lines.append(f'  robot{number}: {{tcf: {board}_jiwy, model: "{model}", bindings: "{bindings}"}}')
    lines.append("connections:")
    for number in range(1, count):
        for axis in ("pan", "tilt"):
            lines.append(f"  - {{from: robot{number - 1}/{axis}_publisher, to: robot{number}/{axis}_subscriber}}")
    lines.append("world: {sends: [robot0/pan_subscriber, robot0/tilt_subscriber]}")
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")


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
