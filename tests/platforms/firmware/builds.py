# SPDX-License-Identifier: Apache-2.0
"""Builds CMake projects with the platform ``firmware`` for several processors, and lists what their libraries need.

A build is kept in EPG's cache, and is brought up to date when a test needs it.

>>> # folder = build(PROCESSORS["m7"], HERE / "builds")
>>> # needed(PROCESSORS["m7"], folder, "jiwy_none_program")     # {"memcpy", "memset", "__aeabi_dmul", ...}
"""

from __future__ import annotations

import hashlib
import shutil
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

from epg.generator.bootstrap import cache_folder
from tests.doubles.toolchain import ROOT, Missing, locked

HERE = Path(__file__).resolve().parent


@dataclass(frozen=True)
class Processor:
    """A processor and its compiler.  ``toolchain``: name of the toolchain file; empty: this computer's compiler."""

    toolchain: str
    options: tuple[str, ...]

    @property
    def prefix(self) -> str:
        return {"arm": "arm-none-eabi-", "riscv": "riscv64-unknown-elf-", "": ""}[self.toolchain]

    def tool(self, name: str) -> str:
        """The path of ``gcc`` or ``nm`` for this processor."""
        path = shutil.which(self.prefix + name)
        if path is None:
            packages = {
                "arm": "gcc-arm-none-eabi libnewlib-arm-none-eabi",
                "riscv": "gcc-riscv64-unknown-elf picolibc-riscv64-unknown-elf",
                "": "gcc",
            }
            raise Missing(f"{self.prefix}{name} is not installed: sudo apt install {packages[self.toolchain]}")
        return path


PROCESSORS = {
    "host": Processor("", ()),
    "m0plus": Processor("arm", ("-mcpu=cortex-m0plus",)),
    "m3": Processor("arm", ("-mcpu=cortex-m3",)),
    "m4f": Processor("arm", ("-mcpu=cortex-m4", "-mfpu=fpv4-sp-d16", "-mfloat-abi=hard")),
    "m33": Processor("arm", ("-mcpu=cortex-m33", "-mfpu=fpv5-sp-d16", "-mfloat-abi=hard")),
    "m7": Processor("arm", ("-mcpu=cortex-m7", "-mfpu=fpv5-d16", "-mfloat-abi=hard")),
    "rv32imac": Processor("riscv", ("-march=rv32imac", "-mabi=ilp32")),
}


def build(processor: Processor, project: Path, **variables: str) -> Path:
    """Configures and builds a project for a processor; returns the build folder.  Raises :class:`Missing`."""
    processor.tool("gcc")
    if shutil.which("ninja") is None:
        raise Missing("Ninja is not installed: sudo apt install ninja-build")
    settings = {"CMAKE_BUILD_TYPE": "Release", "Python3_EXECUTABLE": sys.executable, **variables}
    if processor.toolchain:
        settings["CMAKE_TOOLCHAIN_FILE"] = str(HERE / "toolchains" / f"{processor.toolchain}.cmake")
        settings["PROCESSOR"] = " ".join(processor.options)
    digest = hashlib.sha256(repr((str(project), ROOT, sorted(settings.items()))).encode()).hexdigest()[:16]
    folder: Path = cache_folder() / "test-build" / f"firmware-{project.name}-{digest}"
    with locked(folder):
        if not (folder / "build.ninja").is_file():
            _run(
                [
                    "cmake",
                    "-S",
                    str(project),
                    "-B",
                    str(folder),
                    "-G",
                    "Ninja",
                    *(f"-D{n}={v}" for n, v in settings.items()),
                ]
            )
        _run(["cmake", "--build", str(folder), "--parallel", "2"])
    return folder


def needed(processor: Processor, folder: Path, program: str) -> set[str]:
    """The symbols that a program needs from outside of its own sources and EPG's libraries."""
    linked = folder / f"{program}.needs.o"
    objects = sorted(map(str, (folder / "CMakeFiles" / f"{program}.dir").rglob("*.o*")))
    # The libraries of the other programs have other symbols, so that the linker takes nothing from them.
    libraries = sorted(map(str, folder.glob("lib*.a")))
    command = [processor.tool("gcc"), *processor.options, *(["-mthumb"] if processor.toolchain == "arm" else [])]
    command += ["-r", "-nostdlib", "-o", str(linked), *objects]
    _run([*command, "-Wl,--start-group", *libraries, "-Wl,--end-group"])
    return {line.split()[-1] for line in _run([processor.tool("nm"), "-u", str(linked)]).splitlines()}


def _run(command: list[str]) -> str:
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, f"{' '.join(command)}\n{done.stdout}\n{done.stderr}"
    return done.stdout
