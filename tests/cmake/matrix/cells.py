# SPDX-License-Identifier: Apache-2.0
"""One cell of the matrix: a project that finds EPG in one way, with one toolchain, CMake and generator."""

from __future__ import annotations

import json
import os
import re
import shutil
import subprocess
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from tests.cmake.matrix.cmakes import cmake
from tests.cmake.matrix.ways import WAYS, Conditions, Installations
from tests.cmake.project import ROOT

HERE = Path(__file__).resolve().parent
MODEL = HERE.parent.parent / "models" / "pid_c"

#: Prefix of the cross compiler; without a cross compiler, the host's own is used.
CROSS = "arm-none-eabi-" if shutil.which("arm-none-eabi-gcc") else ""

CMAKES = ("oldest", "newest")

GENERATORS = ("Ninja", "Unix Makefiles", "Ninja Multi-Config")

#: The last lines of ``find_epg.cmake``: they print which EPG was found.
SAY_WHICH = '_epg_data_folder(_epg_data)\nmessage(STATUS "EPG of ${_epg_data}")\n'


@dataclass(frozen=True)
class Convention:
    """The way in which projects of one kind select their compiler."""

    arguments: Callable[[Path], tuple[str, ...]]  #: function of the project's folder
    confined: bool = False  #: packages are searched in a sysroot only
    processor: str = ""  #: lines that readelf prints for objects of a cross compiler
    floats: str = ""
    program: str = "firmware"


CONVENTIONS = {
    "native": Convention(lambda project: ()),
    "pico": Convention(lambda project: (f"-DCROSS={CROSS}",), True, "v6S-M", program="firmware.elf"),
    "cubemx": Convention(
        lambda project: (
            f"-DCROSS={CROSS}",
            f"-DCMAKE_TOOLCHAIN_FILE={project / 'cmake/gcc-arm-none-eabi.cmake'}",
        ),
        False,
        "v7E-M",
        "VFP registers",
        "firmware.elf",
    ),
    "zephyr": Convention(
        lambda project: (f"-DCROSS={CROSS}", "-DBOARD=nucleo_h743zi"), False, "v7E-M", "VFP registers", "zephyr.elf"
    ),
}


@dataclass(frozen=True)
class Cell:
    way: str
    convention: str
    cmake: str  #: oldest or newest
    generator: str

    def __str__(self) -> str:
        return f"{self.way}-{self.convention}-{self.cmake}-{self.generator.replace(' ', '_')}"


ALL = [
    Cell(way, convention, version, generator)
    for way in WAYS
    for convention in CONVENTIONS
    for version in CMAKES
    for generator in GENERATORS
]

PAIRWISE = [
    Cell(way, convention, CMAKES[(row + column // 2) % 2], GENERATORS[(row + column) % 3])
    for row, way in enumerate(WAYS)
    for column, convention in enumerate(CONVENTIONS)
]
"""Cells in which every pair of values of two columns (way, convention, CMake, generator) occurs at least once."""

EACH = [PAIRWISE[4 * row + (row + row // 4) % 4] for row in range(len(WAYS))]
"""One cell of :data:`PAIRWISE` for each way; each of the four conventions occurs with both CMakes."""


def check(cell: Cell, have: Installations, folder: Path) -> None:
    """Configures, builds and runs the cell's project in ``folder`` like its user; asserts all results."""
    convention = CONVENTIONS[cell.convention]
    project, build = folder / "project", folder / "build"
    found = WAYS[cell.way](have, Conditions(convention.confined, cell.cmake == "oldest"))
    shutil.copytree(HERE / "conventions" / cell.convention, project)
    shutil.copytree(MODEL, project / "model")
    for file in (HERE / "main.c", *found.copied):
        shutil.copy(file, project)
    (project / "find_epg.cmake").write_text(f"{found.text}{SAY_WHICH}")

    ignored = ("EPG_", "CMAKE_", "PICO_", "ZEPHYR_", "Python3_", "VIRTUAL_ENV")
    kept = [key for key in os.environ if not key.startswith(ignored) or key.endswith("_COMPILER_LAUNCHER")]
    environment = {key: os.environ[key] for key in kept}
    environment |= {"ZEPHYR_BASE": str(project / "base"), **found.environment}
    # ctest's PYTHONPATH has the packages that tests need, and EPG itself
    paths = [path for path in environment.pop("PYTHONPATH", "").split(os.pathsep) if path and Path(path) != ROOT]
    environment |= {"PYTHONPATH": os.pathsep.join(paths)} if paths else {}
    if "EPG_CACHE" in os.environ:
        environment["EPG_CACHE"] = os.environ["EPG_CACHE"]

    def run(*command: str | Path) -> str:
        done = subprocess.run(
            command, cwd=folder, env=environment, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True
        )
        assert done.returncode == 0, f"{' '.join(map(str, command))}\n{done.stdout}"
        return done.stdout

    program = cmake(cell.cmake)
    arguments = (*convention.arguments(project), *found.arguments)
    output = run(program, "-S", project, "-B", build, "-G", cell.generator, *arguments)
    assert not re.search("warning|deprecat", output, re.IGNORECASE), output
    assert f"EPG of {(build / found.leads_to).as_posix()}\n" in output, output

    _compile_from_database(project / "main.c", build)
    run(program, "--build", build)
    (result,) = (path for path in build.rglob(convention.program) if path.is_file())
    if CROSS and convention.processor:
        _check_objects(result, convention)
        for library in build.rglob("libpan.a"):
            _check_objects(library, convention)
    else:
        run(result)

    before = _times(build / "epg")
    output = run(program, build)
    assert not re.search("warning|deprecat", output, re.IGNORECASE), output
    assert _times(build / "epg") == before, "a second configuration has touched generated files"


def _compile_from_database(source: Path, build: Path) -> None:
    """An editor that has read compile_commands.json finds every header, even before the first build."""
    commands = json.loads((build / "compile_commands.json").read_text())
    command = next(entry for entry in commands if Path(entry["file"]) == source)
    words = command["command"].replace(" -o ", " -fsyntax-only -o ", 1)
    done = subprocess.run(words, shell=True, cwd=command["directory"], capture_output=True, text=True)
    assert done.returncode == 0, f"{words}\n{done.stderr}"


def _check_objects(file: Path, convention: Convention) -> None:
    """All objects of a library or program are for the processor and its convention for floating-point arguments."""
    text = subprocess.run([f"{CROSS}readelf", "-hA", str(file)], capture_output=True, text=True, check=True).stdout
    objects = text.count("ELF Header:")
    assert objects
    assert text.count("Machine:") == len(re.findall(r"Machine: +ARM\n", text)) == objects
    assert len(re.findall(rf"Tag_CPU_arch: {convention.processor}\n", text)) == objects, f"{file}\n{text}"
    found = len(re.findall(rf"Tag_ABI_VFP_args: {convention.floats}\n", text)) if convention.floats else 0
    assert found == (objects if convention.floats else 0), f"{file}\n{text}"
    assert convention.floats or "Tag_ABI_VFP_args" not in text


def _times(folder: Path) -> dict[str, int]:
    return {str(path): path.stat().st_mtime_ns for path in folder.rglob("*") if path.is_file()}
