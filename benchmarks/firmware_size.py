# SPDX-License-Identifier: Apache-2.0
"""Measures JIWY in a program for any chip: flash and memory by middleware and build type.

The chip is a Cortex-M4F, the options are those of STM32CubeMX's projects: ``-O0 -g3`` for Debug, ``-Os -g0`` for
Release.  The drivers are the generated stubs.
"""

from __future__ import annotations

import subprocess
from pathlib import Path

from measure import need
from report import Table, arguments, command_line, show

from tests.doubles.toolchain import xrce_libraries
from tests.platforms.firmware.builds import HERE, PROCESSORS, build

MIDDLEWARES = {"none": "none", "console": "console", "xrce": "xrce and console"}
PROCESSOR = PROCESSORS["m4f"]
FLAGS = {"CMAKE_C_FLAGS_DEBUG": "-O0 -g3", "CMAKE_C_FLAGS_RELEASE": "-Os -g0"}
BUILDS = {
    "Release": {"CMAKE_BUILD_TYPE": "Release"},
    "Debug": {"CMAKE_BUILD_TYPE": "Debug"},
    "Debug, EPG_OPTIMIZE=OFF": {"CMAKE_BUILD_TYPE": "Debug", "EPG_OPTIMIZE": "OFF"},
}


def main() -> None:
    options = arguments(__doc__)
    need(lambda: PROCESSOR.tool("gcc"), xrce_libraries)
    folders = {name: build(PROCESSOR, HERE / "builds", **FLAGS, **settings) for name, settings in BUILDS.items()}
    rows = []
    for middleware, title in MIDDLEWARES.items():
        sizes = [size_of(folder / f"jiwy_{middleware}_program") for folder in folders.values()]
        rows.append([title, *(f"{flash:,}" for flash, _ in sizes), *(f"{memory:,}" for _, memory in sizes[:1])])
    table = Table(
        "Flash and memory of JIWY in a program for any chip",
        ["middleware", *(f"flash, {name}" for name in BUILDS), "memory"],
        rows,
        ["Bytes of the linked program on a Cortex-M4F: code, constants and initial values; variables. Without drivers, "
         "stacks and start-up code."],
    )  # fmt: skip
    show("firmware_size", [table], options.write, command_line("firmware_size"))


def size_of(program: Path) -> tuple[int, int]:
    """Bytes of flash and of memory."""
    done = subprocess.run([PROCESSOR.tool("size"), str(program)], capture_output=True, text=True, check=True)
    text, data, bss = map(int, done.stdout.splitlines()[1].split()[:3])
    return text + data, data + bss


if __name__ == "__main__":
    main()
