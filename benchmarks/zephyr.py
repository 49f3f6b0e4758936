# SPDX-License-Identifier: Apache-2.0
"""Measures what EPG adds to a Zephyr application: the time to configure, and the size of the image.

The time to configure is compared with that of the same application without EPG, with copies of the generated overlay,
configuration and C files. The latter is the time that Zephyr and CMake themselves need. Both times are processor times
of CMake and of all programs that it starts, one after the other, so other work on the computer has little influence.
"""

from __future__ import annotations

import json
import os
import re
import resource
import shutil
import statistics
import subprocess
import tempfile
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from pathlib import Path

from measure import JIWY, ROOT
from report import Table, arguments, command_line, milliseconds, show

from tests.doubles.toolchain import Missing, arm_gcc
from tests.zephyr.workspace import Workspace, build, c_library, run, workspace

BOARDS = ("rpi_pico", "nucleo_h743zi", "rpi_pico2/rp2350a/m33")
COPIED, EPG = "files copied", "EPG"
BORDER = 3.0
"""The largest time that EPG may add to a configure run, in per cent."""

MAIN = """#include <zephyr/kernel.h>
#include "jiwy.h"

int main(void)
{
    return jiwy_start() ? 0 : 1;
}
"""
HEAD = "cmake_minimum_required(VERSION 3.22)\n"
TAIL = """find_package(Zephyr REQUIRED HINTS $ENV{ZEPHYR_BASE})
project(app)
target_sources(app PRIVATE main.c)
"""


def main() -> None:
    options = arguments(__doc__, rounds=5, boards=len(BOARDS))
    os.environ.pop("PYTHONDONTWRITEBYTECODE", None)  # Python compiles modules and templates only once, as for users
    try:
        here = workspace(*BOARDS)
        c_library()
    except Missing as missing:
        raise SystemExit(str(missing)) from None
    boards = BOARDS[: options.boards]
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        rows = [row for board in boards[:2] for row in times(folder / board, board, here, options.rounds)]
    note = f"Aim: EPG adds at most {BORDER:.0f} %. Ratios are medians of those within {options.rounds} rounds."
    head = ("board", "build folder", f"{COPIED}, ms", "EPG, ms", "EPG adds, ms", "EPG adds, %")
    configuring = Table("Configuring JIWY (cmake), processor time", head, rows, (note,))
    head = ("board", "what", "text", "data", "bss")
    image = Table("Size of images, bytes", head, [row for board in boards for row in sizes(board)])
    show("zephyr", [configuring, image], options.write, command_line("zephyr"))


def times(folder: Path, board: str, here: Workspace, rounds: int) -> list[list[str]]:
    """The rows of a board: for a new build folder, and for one in which nothing has changed."""
    projects = write_projects(folder, board, here)
    again = {name: partial(configure, path, board, here) for name, path in projects.items()}
    cold = {name: partial(new_build, path, board, here) for name, path in projects.items()}
    unchanged = processor_times(again, rounds)
    return [cost(board, "new", processor_times(cold, rounds)), cost(board, "unchanged", unchanged)]


def processor_times(actions: Mapping[str, Callable[[], object]], rounds: int) -> dict[str, list[float]]:
    """Processor time in seconds of each action with all programs that it starts.  The actions run in turns.

    Caches must be warm.
    """
    taken: dict[str, list[float]] = {name: [] for name in actions}
    for _ in range(rounds):
        for name, action in actions.items():
            before = resource.getrusage(resource.RUSAGE_CHILDREN)
            action()
            after = resource.getrusage(resource.RUSAGE_CHILDREN)
            taken[name].append(after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime)
    return taken


def cost(board: str, what: str, taken: Mapping[str, Sequence[float]]) -> list[str]:
    copied, epg = (statistics.median(taken[name]) for name in (COPIED, EPG))
    share = statistics.median(100 * (b / a - 1) for a, b in zip(taken[COPIED], taken[EPG]))
    added = statistics.median(b - a for a, b in zip(taken[COPIED], taken[EPG]))
    return [board, what, milliseconds(copied), milliseconds(epg), milliseconds(added), f"{share:.1f}"]


def write_projects(folder: Path, board: str, here: Workspace) -> Mapping[str, Path]:
    """Writes and builds the application with EPG and the one with copied files.

    Ends the benchmark if their images differ in size by more than 0.5 %.
    """
    projects = {name: folder / name.replace(" ", "_") for name in (EPG, COPIED)}
    for path in projects.values():
        path.mkdir(parents=True)
        (path / "main.c").write_text(MAIN, encoding="utf-8")
    tcf = f"{board.split('/')[0]}_zephyr_jiwy.tcf"
    epg = f'include("{(ROOT / "cmake" / "EPGConfig.cmake").as_posix()}")\n'
    epg += f'epg_add_target(jiwy TCF {tcf} MODEL "{(JIWY / "model").as_posix()}"'
    epg += f' BINDINGS "{(JIWY / "jiwy.bindings.yaml").as_posix()}")\n'
    (projects[EPG] / "CMakeLists.txt").write_text(HEAD + epg + TAIL, encoding="utf-8")
    (projects[EPG] / "prj.conf").write_text("", encoding="utf-8")
    configure(projects[EPG], board, here)
    copy_files(projects[EPG] / "build", projects[COPIED], board, here)
    configure(projects[COPIED], board, here)
    images = []
    for path in projects.values():
        run(["ninja", "-C", str(path / "build")], here)
        images.append(size_of(path / "build"))
    if abs(images[0][0] - images[1][0]) > images[0][0] / 200:
        raise SystemExit(f"the images are not the same: {images}")
    return projects


def copy_files(built: Path, project: Path, board: str, here: Workspace) -> None:
    """Writes CMakeLists.txt, overlay and prj.conf of ``project``, with the files of ``built``, a build with EPG."""
    defaults = (built / "epg" / "jiwy" / "jiwy.Kconfig").read_text(encoding="utf-8")
    symbols = {f"CONFIG_{symbol}" for symbol in re.findall(r"^configdefault (\w+)", defaults, re.MULTILINE)}
    final = (built / "zephyr" / ".config").read_text(encoding="utf-8").splitlines()
    lines = [line for line in final if line.split("=")[0] in symbols]
    (project / "prj.conf").write_text("\n".join(lines) + "\n", encoding="utf-8")
    shutil.copy(built / "epg" / "jiwy" / "jiwy.overlay", project / "app.overlay")
    (project / "CMakeLists.txt").write_text(HEAD + TAIL, encoding="utf-8")
    shutil.copy(built / "epg" / "jiwy" / "jiwy.h", project / "jiwy.h")
    configure(project, board, here)
    by_module = set(compiled(project / "build"))
    theirs = [here.base, *(module for module in here.modules if module != ROOT)]
    theirs += [folder for folder in built.iterdir() if folder.name != "epg"]
    own = {path: command for path, command in compiled(built).items() if path not in by_module}
    body = _sources({path: command for path, command in own.items() if not _is_below(path, theirs)}, theirs)
    (project / "CMakeLists.txt").write_text(HEAD + TAIL + body, encoding="utf-8")
    (project / "jiwy.h").unlink()
    shutil.rmtree(project / "build")


def _sources(commands: dict[str, str], theirs: Sequence[Path]) -> str:
    """The lines of a CMakeLists.txt for the sources of ``commands``, without folders of headers inside ``theirs``."""
    body = ""
    folders: dict[str, None] = {}
    for path, command in commands.items():
        body += f'target_sources(app PRIVATE "{path}")\n'
        named = re.findall(r"(?: -I|-isystem )(\S+)", command)
        folders |= dict.fromkeys(name for name in named if not _is_below(name, theirs))
        forced = re.findall(r"-include (\S+/epg/\S+)", command)
        if forced:
            body += f'set_source_files_properties("{path}" PROPERTIES COMPILE_OPTIONS "-w;-include;{forced[0]}")\n'
    return body + "".join(f'target_include_directories(app PRIVATE "{path}")\n' for path in folders)


def _is_below(path: str, folders: Sequence[Path]) -> bool:
    return any(Path(path).is_relative_to(folder) for folder in folders)


def compiled(folder: Path) -> dict[str, str]:
    """Every source file of a build except the application's main.c, with its compiler command."""
    entries = json.loads((folder / "compile_commands.json").read_text(encoding="utf-8"))
    return {entry["file"]: entry["command"] for entry in entries if not entry["file"].endswith("main.c")}


def new_build(project: Path, board: str, here: Workspace) -> None:
    shutil.rmtree(project / "build", ignore_errors=True)
    configure(project, board, here)


def configure(project: Path, board: str, here: Workspace) -> None:
    """Configures as west does, with west's Python.  Zephyr's own caches in the user's folder are warm."""
    modules = ";".join(str(path) for path in here.modules)
    command = ["cmake", "-G", "Ninja", "-S", str(project), "-B", str(project / "build"), f"-DBOARD={board}"]
    settings = [f"-D{name}={value}" for name, value in {"WEST_PYTHON": str(here.python), **c_library()}.items()]
    run([*command, *settings, f"-DZEPHYR_MODULES={modules}"], here)


def sizes(board: str) -> list[list[str]]:
    """The rows of a board: an empty application, and JIWY's."""
    rows = []
    for what, application in (
        ("Zephyr alone", "tests/zephyr/empty"),
        ("with JIWY's controller", "examples/zephyr_jiwy/app"),
    ):
        folder = build(application, board, settings={"EPG_PATH": str(ROOT), **c_library()})
        rows.append([board, what, *(f"{size:,}" for size in size_of(folder))])
    return rows


def size_of(folder: Path) -> tuple[int, ...]:
    """The sizes of text, data and bss in bytes."""
    program = arm_gcc().with_name("arm-none-eabi-size")
    done = subprocess.run(
        [str(program), str(folder / "zephyr" / "zephyr.elf")], capture_output=True, text=True, check=True
    )
    return tuple(int(word) for word in done.stdout.splitlines()[1].split()[:3])


if __name__ == "__main__":
    main()
