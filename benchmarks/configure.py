# SPDX-License-Identifier: Apache-2.0
"""Measures the time that EPG adds to a CMake configure run: JIWY for the host against two projects without EPG.

The first project has only one executable.  The second one builds copies of the files that EPG has generated, with the
same libraries; it shows the time that CMake itself needs for them.  If nothing has changed, no project has any work in
a second configure run.
"""

from __future__ import annotations

import shutil
import statistics
import sys
import tempfile
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from pathlib import Path

from measure import EPG, JIWY, ROOT, all_in_turns, run
from report import Table, arguments, command_line, milliseconds, show

BORDER = 0.005
EMPTY, COPIED, JIWY_PROJECT = "empty", "files copied", "EPG"


def main() -> None:
    options = arguments(__doc__, rounds=15)
    if shutil.which("cmake") is None:
        raise SystemExit("cmake is not installed: apt install cmake")
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        projects = write_projects(folder)
        cold = all_in_turns({p: partial(new_build, projects[p]) for p in projects}, max(1, options.rounds // 3))
        again = all_in_turns({p: partial(configure, projects[p]) for p in projects}, options.rounds)
        edited = all_in_turns({p: edit(projects[p]) for p in projects}, max(1, options.rounds // 3))
    table = costs({"new build folder": cold, "one value edited": edited, "unchanged": again})
    show("configure", [table], options.write, command_line("configure"))


def write_projects(folder: Path) -> Mapping[str, Path]:
    """Writes the projects.  They differ only in the lines of CMakeLists.txt between project() and the executable."""
    head = "cmake_minimum_required(VERSION 3.22)\nproject(bench LANGUAGES C)\n"
    body = "add_executable(bench main.c)\n"
    epg = f'include("{(ROOT / "cmake" / "EPGConfig.cmake").as_posix()}")\n'
    model = (JIWY / "model").as_posix()
    epg += f'epg_add_target(jiwy TCF own.tcf MODEL "{model}" BINDINGS "{(JIWY / "jiwy.bindings.yaml").as_posix()}")\n'
    additions = {EMPTY: "", COPIED: copied(folder / "generated"), JIWY_PROJECT: epg}
    projects = {name: folder / name.replace(" ", "_") for name in additions}
    for name, path in projects.items():
        path.mkdir()
        (path / "main.c").write_text("int main(void)\n{\n    return 0;\n}\n", encoding="utf-8")
        (path / "own.tcf").write_text(own_tcf("33 ms"), encoding="utf-8")
        (path / "CMakeLists.txt").write_text(head + additions[name] + body, encoding="utf-8")
    return projects


def copied(output: Path) -> str:
    """CMake code for libraries with the same sources as EPG's, as a user would write it without EPG."""
    command: list[str | Path] = [sys.executable, EPG, "generate", "jiwy", "--tcf", "host_jiwy.tcf"]
    command += ["--model", JIWY / "model", "--bindings", JIWY / "jiwy.bindings.yaml"]
    run([*command, "--output", output])
    runtime, host = ROOT / "targets" / "runtime", ROOT / "targets" / "platforms" / "host"
    console = ROOT / "targets" / "middlewares" / "console"
    platform = [path for path in sorted((host / "src").glob("*.c")) if path.name != "main.c"]
    exported = [output / "jiwy_model_export.c", *sorted((JIWY / "model").glob("*.c"))]
    kinds = [str(path) for path in sorted((ROOT / "targets" / "components").iterdir()) if path.is_dir()]
    return f"""add_library(epg_runtime STATIC EXCLUDE_FROM_ALL {listed(sorted((runtime / "src").glob("*/*.c")))})
target_include_directories(epg_runtime PUBLIC "{runtime / "include"}")
add_library(epg_host STATIC EXCLUDE_FROM_ALL {listed(platform)})
target_include_directories(epg_host PUBLIC "{host / "include"}")
target_link_libraries(epg_host PUBLIC epg_runtime -pthread m)
add_library(console STATIC EXCLUDE_FROM_ALL {listed(sorted(console.glob("*.c")))})
target_include_directories(console PUBLIC "{console}")
target_link_libraries(console PUBLIC epg_runtime)
add_library(export OBJECT EXCLUDE_FROM_ALL {listed(exported)})
target_include_directories(export PRIVATE "{JIWY / "model"}" "{output}")
target_compile_options(export PRIVATE -w "SHELL:-include {output / "jiwy_model_names.h"}")
add_library(model STATIC "{output / "jiwy_model.c"}" $<TARGET_OBJECTS:export>)
target_include_directories(model PUBLIC "{output}")
add_library(jiwy STATIC {listed(sorted(output / f"jiwy_{part}.c" for part in ("app", "host", "version")))})
target_include_directories(jiwy PRIVATE {" ".join(kinds)})
target_link_libraries(jiwy PUBLIC epg_host model console)
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
    beyond: dict[str, float] = {}
    for what, values in times.items():
        for name in (EMPTY, COPIED):
            beyond[name] = statistics.median(epg - other for epg, other in zip(values[JIWY_PROJECT], values[name]))
        medians = [milliseconds(statistics.median(values[name])) for name in (EMPTY, COPIED, JIWY_PROJECT)]
        rows.append([what, *medians, *(milliseconds(beyond[name]) for name in (EMPTY, COPIED))])
    judged = {name: "holds" if beyond[name] <= BORDER else "does not hold" for name in beyond}
    notes = [
        f"Aim: unchanged adds at most {milliseconds(BORDER)} ms to an empty project: {judged[EMPTY]}; to one with the "
        f"same libraries: {judged[COPIED]}. Added is the median of the differences within the rounds."
    ]
    head = ["what", EMPTY, COPIED, JIWY_PROJECT, f"added to {EMPTY}", f"added to {COPIED}"]
    return Table("Configuring (cmake), ms", head, rows, notes)


if __name__ == "__main__":
    main()
