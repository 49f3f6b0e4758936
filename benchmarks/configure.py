"""What EPG adds to CMake: configuring JIWY for the host against configuring a project without EPG.

Both are projects in C that need the same compiler; configured again, neither has anything to do.
"""

from __future__ import annotations

import shutil
import statistics
import sys
import tempfile
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from pathlib import Path

from measure import JIWY, ROOT, all_in_turns, run
from report import Table, arguments, command_line, milliseconds, show

BORDER = 0.005
EMPTY, JIWY_PROJECT = "project without EPG", "JIWY"


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
    """The two projects: one line more in the second."""
    head = "cmake_minimum_required(VERSION 3.22)\nproject(bench LANGUAGES C)\n"
    body = "add_executable(bench main.c)\n"
    epg = f'include("{(ROOT / "cmake" / "EPGConfig.cmake").as_posix()}")\n'
    model = (JIWY / "model").as_posix()
    epg += f'epg_add_target(jiwy TCF own.tcf MODEL "{model}" BINDINGS "{(JIWY / "jiwy.bindings.yaml").as_posix()}")\n'
    projects = {EMPTY: folder / "empty", JIWY_PROJECT: folder / "jiwy"}
    for name, path in projects.items():
        path.mkdir()
        (path / "main.c").write_text("int main(void)\n{\n    return 0;\n}\n", encoding="utf-8")
        (path / "own.tcf").write_text(own_tcf("33 ms"), encoding="utf-8")
        (path / "CMakeLists.txt").write_text(head + (epg if name == JIWY_PROJECT else "") + body, encoding="utf-8")
    return projects


def own_tcf(period: str) -> str:
    return f"version: 1\nextends: host_jiwy.tcf\ncommunication: {{period: {period}}}\n"


def configure(project: Path) -> None:
    run(["cmake", "-S", project, "-B", project / "build", f"-DPython3_EXECUTABLE={sys.executable}"])


def new_build(project: Path) -> None:
    shutil.rmtree(project / "build", ignore_errors=True)
    configure(project)


def edit(project: Path) -> Callable[[], None]:
    """Each call changes the configuration, whether the project knows of it or not."""
    number = 0

    def action() -> None:
        nonlocal number
        number += 1
        (project / "own.tcf").write_text(own_tcf(f"{20 + number % 10} ms"), encoding="utf-8")
        configure(project)

    return action


def costs(times: Mapping[str, Mapping[str, Sequence[float]]]) -> Table:
    rows = []
    added = 0.0
    for what, values in times.items():
        differences = [jiwy - empty for jiwy, empty in zip(values[JIWY_PROJECT], values[EMPTY])]
        added = statistics.median(differences)
        medians = [milliseconds(statistics.median(values[name])) for name in (EMPTY, JIWY_PROJECT)]
        rows.append([what, *medians, milliseconds(added)])
    judged = "holds" if added <= BORDER else "does not hold"
    note = f"Aim: unchanged adds at most {milliseconds(BORDER)} ms: {judged}. Added is the median of the differences."
    return Table("Configuring (cmake), ms", ["what", EMPTY, JIWY_PROJECT, "added"], rows, [note])


if __name__ == "__main__":
    main()
