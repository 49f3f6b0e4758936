# SPDX-License-Identifier: Apache-2.0
"""Images of ``project/`` for a board and a platform, built once and kept in EPG's cache."""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path

from tests.doubles.rp2040.build import build
from tests.doubles.toolchain import arm_gcc, binutils, node, pico_sdk, rp2040js, skip_if_missing, tool

PROJECT = "tests/platforms/pico/project"
BOARDS = ("pico", "pico2")
PLATFORMS = ("bare_metal", "freertos")
TARGETS = [(board, platform) for board in BOARDS for platform in PLATFORMS]


def freertos_kernel() -> Path:
    return tool("freertos_kernel")


def skip_unless_buildable(platform: str) -> None:
    """Skips the test if the SDK, the compiler, or the kernel of ``platform`` is missing."""
    skip_if_missing(pico_sdk, arm_gcc, *([freertos_kernel] if platform == "freertos" else []))


def skip_unless_emulated(platform: str) -> None:
    skip_unless_buildable(platform)
    skip_if_missing(node, rp2040js)


def images(board: str, platform: str, *names: str, middleware: str = "none", stock_arithmetic: bool = False) -> Path:
    """Builds ``names``.elf and returns their folder; SDK and compiler must be installed."""
    variables = {"PLATFORM": platform, "MIDDLEWARE": middleware}
    return build(PROJECT, board=board, targets=names, variables=variables, stock_arithmetic=stock_arithmetic)


@dataclass(frozen=True)
class Size:
    """Bytes of an image, as ``size`` counts them."""

    text: int
    data: int
    bss: int


def size_of(elf: Path) -> Size:
    output = binutils("size", str(elf)).splitlines()[1].split()
    return Size(*(int(number) for number in output[:3]))


def ram_of(elf: Path) -> int:
    """Bytes of RAM that an image takes: code, constants, variables, and the stacks and the heap that it reserves."""
    total = 0
    for line in binutils("readelf", "-SW", str(elf)).splitlines():
        section = re.match(r" *\[ *\d+\] \S+ +\S+ +([0-9a-f]{8}) [0-9a-f]+ ([0-9a-f]+) [0-9a-f]+ +\w*A", line)
        if section and 0x20000000 <= int(section[1], 16) < 0x30000000:
            total += int(section[2], 16)
    return total
