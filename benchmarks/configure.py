# SPDX-License-Identifier: Apache-2.0
"""Measures the time that EPG adds to a CMake configure run: JIWY for the host against two projects without EPG.

The first project has only one executable.  The second one builds copies of the files that EPG has generated, with the
same libraries; it shows the time that CMake itself needs for them.  If nothing has changed, no project has any work in
a second configure run.  Projects with several targets show the time for each further target: the first one also takes
the time to load EPG's CMake package, and to compare EPG's own code with that of the last run.
"""

from __future__ import annotations

import shutil
import statistics
import sys
import tempfile
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from pathlib import Path

from measure import EPG, JIWY, ROOT, all_in_turns, jiwy_files, run
from report import Table, arguments, command_line, milliseconds, show

BORDER = 0.005
SEVERAL = 11
EMPTY, COPIED, JIWY_PROJECT = "empty", "files copied", "EPG"


def main() -> None:
    options = arguments(__doc__, rounds=15)
    if shutil.which("cmake") is None:
        raise SystemExit("cmake is not installed: apt install cmake")
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        projects = write_projects(folder / "one")
        several = write_projects(folder / "several", SEVERAL)
        for project in several.values():
            configure(project)
        cold = all_in_turns({p: partial(new_build, projects[p]) for p in projects}, max(1, options.rounds // 3))
        one = {p: partial(configure, projects[p]) for p in projects}
        eleven = {f"{p}, several": partial(configure, several[p]) for p in (COPIED, JIWY_PROJECT)}
        again = all_in_turns({**one, **eleven}, options.rounds)
        edited = all_in_turns({p: edit(projects[p]) for p in projects}, max(1, options.rounds // 3))
    tables = [costs({"new build folder": cold, "one value edited": edited, "unchanged": again}), further_costs(again)]
    show("configure", tables, options.write, command_line("configure"))


def write_projects(folder: Path, targets: int = 1) -> Mapping[str, Path]:
    """Writes the projects with a number of equal targets.

    They differ only in the lines of CMakeLists.txt between project() and the executable.
    """
    folder.mkdir()
    head = "cmake_minimum_required(VERSION 3.22)\nproject(bench LANGUAGES C)\n"
    body = "add_executable(bench main.c)\n"
    epg = f'include("{(ROOT / "cmake" / "EPGConfig.cmake").as_posix()}")\n'
    model = (JIWY / "model").as_posix()
    bindings = (JIWY / "jiwy.bindings.yaml").as_posix()
    names = ["jiwy", *(f"jiwy{number}" for number in range(1, targets))]
    epg += "".join(f'epg_add_target({name} TCF own.tcf MODEL "{model}" BINDINGS "{bindings}")\n' for name in names)
    libraries = shared_libraries() + "".join(copied(folder / "generated" / name, name) for name in names)
    additions = {EMPTY: "", COPIED: libraries, JIWY_PROJECT: epg}
    projects = {name: folder / name.replace(" ", "_") for name in additions}
    for name, path in projects.items():
        path.mkdir()
        (path / "main.c").write_text("int main(void)\n{\n    return 0;\n}\n", encoding="utf-8")
        (path / "own.tcf").write_text(own_tcf("33 ms"), encoding="utf-8")
        (path / "CMakeLists.txt").write_text(head + additions[name] + body, encoding="utf-8")
    return projects


def shared_libraries() -> str:
    """CMake code for the libraries that all targets share, with the sources of EPG's."""
    runtime, host = ROOT / "targets" / "runtime", ROOT / "targets" / "platforms" / "host"
    console = ROOT / "targets" / "middlewares" / "console"
    sources = sorted([*host.glob("src/*/*.c"), *host.glob("src/*/linux/*.c")])
    platform = [path for path in sources if path.name != "main.c"]
    return f"""add_library(epg_runtime STATIC EXCLUDE_FROM_ALL {listed(sorted((runtime / "src").glob("*/*.c")))})
target_include_directories(epg_runtime PUBLIC "{runtime / "include"}")
add_library(epg_host STATIC EXCLUDE_FROM_ALL {listed(platform)})
target_include_directories(epg_host PUBLIC "{host / "include"}" PRIVATE "{host / "src"}" "{console}")
target_link_libraries(epg_host PUBLIC epg_runtime -pthread m)
add_library(console STATIC EXCLUDE_FROM_ALL {listed(sorted(console.glob("*.c")))})
target_include_directories(console PUBLIC "{console}")
target_link_libraries(console PUBLIC epg_runtime)
"""


def copied(output: Path, name: str) -> str:
    """CMake code for the libraries of one target with the sources of EPG's, as a user would write it without EPG."""
    run([sys.executable, EPG, "generate", name, *jiwy_files("host_jiwy.tcf"), "--output", output])
    exported = [output / f"{name}_model_export.c", *sorted((JIWY / "model").glob("*.c"))]
    kinds = [str(path) for path in sorted((ROOT / "targets" / "components").iterdir()) if path.is_dir()]
    return f"""add_library({name}_export OBJECT EXCLUDE_FROM_ALL {listed(exported)})
target_include_directories({name}_export PRIVATE "{JIWY / "model"}" "{output}")
target_compile_options({name}_export PRIVATE -w "SHELL:-include {output / f"{name}_model_names.h"}")
add_library({name}_model STATIC "{output / f"{name}_model.c"}" $<TARGET_OBJECTS:{name}_export>)
target_include_directories({name}_model PUBLIC "{output}")
add_library({name} STATIC {listed(sorted(output / f"{name}_{part}.c" for part in ("app", "host", "version")))})
target_include_directories({name} PRIVATE {" ".join(kinds)})
target_link_libraries({name} PUBLIC epg_host {name}_model console)
"""


def listed(paths: Sequence[Path]) -> str:
    return " ".join(f'"{path.as_posix()}"' for path in paths)


def own_tcf(period: str) -> str:
    return f"version: 1\nextends: host_jiwy.tcf\ncommunication: {{period: {period}}}\n"


def configure(project: Path) -> None:
    run(["cmake", "-S", project, "-B", project / "build", f"-DPython3_EXECUTABLE={sys.executable}"])


def new_build(project: Path) -> None:
    shutil.rmtree(project / "build", ignore_errors=True)
    configure(project)


def edit(project: Path) -> Callable[[], None]:
    """A function that changes the .tcf file and configures.  Projects without EPG do not read that file."""
    number = 0

    def action() -> None:
        nonlocal number
        number += 1
        (project / "own.tcf").write_text(own_tcf(f"{20 + number % 10} ms"), encoding="utf-8")
        configure(project)

    return action


def costs(times: Mapping[str, Mapping[str, Sequence[float]]]) -> Table:
    rows = []
    for what, values in times.items():
        beyond = {name: added(values[JIWY_PROJECT], values[name]) for name in (EMPTY, COPIED)}
        medians = [milliseconds(statistics.median(values[name])) for name in (EMPTY, COPIED, JIWY_PROJECT)]
        rows.append([what, *medians, *(milliseconds(beyond[name]) for name in (EMPTY, COPIED))])
    notes = ["Added is the median of the differences within the rounds."]
    head = ["what", EMPTY, COPIED, JIWY_PROJECT, f"added to {EMPTY}", f"added to {COPIED}"]
    return Table("Configuring (cmake), ms", head, rows, notes)


def further_costs(times: Mapping[str, Sequence[float]]) -> Table:
    """The times of unchanged projects with one target and with several, and the time for each further target."""
    rows = []
    each: dict[str, float] = {}
    for name in (COPIED, JIWY_PROJECT):
        several = times[f"{name}, several"]
        each[name] = added(several, times[name]) / (SEVERAL - 1)
        columns = statistics.median(times[name]), statistics.median(several), each[name]
        rows.append([name, *map(milliseconds, columns)])
    beyond = each[JIWY_PROJECT] - each[COPIED]
    judged = "holds" if beyond <= BORDER else f"missed by {milliseconds(beyond - BORDER)} ms"
    notes = [
        f"Aim: an unchanged target adds at most {milliseconds(BORDER)} ms to a project with the same libraries: "
        f"{judged} ({milliseconds(beyond)} ms). The first target also takes the time to load EPG's CMake package, and "
        "to compare EPG's own code with that of the last run."
    ]
    head = ["what", "1 target", f"{SEVERAL} targets", "each further target"]
    return Table("Configuring several targets, unchanged, ms", head, rows, notes)


def added(one: Sequence[float], other: Sequence[float]) -> float:
    """The median of the differences within the rounds."""
    return statistics.median(a - b for a, b in zip(one, other))


if __name__ == "__main__":
    main()
