# SPDX-License-Identifier: Apache-2.0
"""Each image of the predefined configurations builds without a warning: JIWY and RELbot (in C++), by middleware."""

from __future__ import annotations

from itertools import product

import pytest

from tests.doubles.rp2040.build import build
from tests.platforms.pico.compiled import own_sources, problems
from tests.platforms.pico.images import PROJECT, TARGETS, images, ram_of, size_of, skip_unless_buildable

RAM = {"pico": 264 * 1024, "pico2": 520 * 1024}
"""In bytes."""
# The radio is not used: chip and port layer are the same as on the boards without a radio.
WIRELESS = [("pico_w", "bare_metal", "none", "jiwy"), ("pico2_w", "freertos", "none", "jiwy")]
PARTS = product(TARGETS, ("none", "console", "xrce", "xrce_console"), ("jiwy", "relbot"))
CELLS = [(*target, middleware, robot) for target, middleware, robot in PARTS]


@pytest.mark.parametrize(("board", "platform", "middleware", "robot"), CELLS + WIRELESS)
def test_each_image_builds(board: str, platform: str, middleware: str, robot: str) -> None:
    skip_unless_buildable(platform)
    name = f"{robot}_firmware"
    folder = images(board, platform, name, middleware=middleware)
    for suffix in ("elf", "uf2", "bin", "hex", "elf.map"):
        assert (folder / f"{name}.{suffix}").stat().st_size > 0
    size = size_of(folder / f"{name}.elf")
    print(f"{robot} {board} {platform} {middleware}: text {size.text}, data {size.data}, bss {size.bss}")
    if (middleware, robot) == ("none", "jiwy"):
        assert ram_of(folder / f"{name}.elf") < RAM[board.removesuffix("_w")] / 5, "with room for the user"
    sources = own_sources(folder)
    if robot == "jiwy":
        needed = {"control_core.c", "service.c", "jiwy_app.c", "jiwy_pico.c", "control.c"}
        assert needed <= {file.name for file in sources}
    assert {file.name: said for file, command in sources.items() if (said := problems(command))} == {}


def test_a_debug_build_whose_libraries_have_a_postfix() -> None:
    """The linker script of the SDK finds the control cycle by the names of archives."""
    skip_unless_buildable("bare_metal")
    debug = {"CMAKE_BUILD_TYPE": "Debug", "CMAKE_DEBUG_POSTFIX": "-debug", "PLATFORM": "bare_metal"}
    folder = build(PROJECT, targets=["jiwy_firmware"], variables=debug)
    assert (folder / "libepg_runtime_libm.a").is_file() and (folder / "libepg_communication_libm.a").is_file()
