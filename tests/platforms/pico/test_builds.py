# SPDX-License-Identifier: Apache-2.0
"""The images for all four targets build, EPG's part without a warning, and have a bounded size."""

from __future__ import annotations

import pytest

from tests.platforms.pico.compiled import own_sources, problems
from tests.platforms.pico.images import TARGETS, images, ram_of, size_of, skip_unless_buildable

RAM = {"pico": 264 * 1024, "pico2": 520 * 1024}
"""In bytes."""


# The radio is not used: chip and port layer are the same as on the boards without a radio.
WIRELESS = [("pico_w", "bare_metal"), ("pico2_w", "freertos")]


@pytest.mark.parametrize(("board", "platform"), [*TARGETS, *WIRELESS])
def test_jiwy_builds(board: str, platform: str) -> None:
    skip_unless_buildable(platform)
    folder = images(board, platform, "jiwy_firmware")
    for suffix in ("elf", "uf2", "bin", "hex", "elf.map"):
        assert (folder / f"jiwy_firmware.{suffix}").stat().st_size > 0
    size = size_of(folder / "jiwy_firmware.elf")
    print(f"{board} {platform}: text {size.text}, data {size.data}, bss {size.bss}")
    assert ram_of(folder / "jiwy_firmware.elf") < RAM[board.removesuffix("_w")] / 5, "with room for the user"


@pytest.mark.parametrize(("board", "platform"), TARGETS)
def test_epgs_c_has_no_warning(board: str, platform: str) -> None:
    skip_unless_buildable(platform)
    sources = own_sources(images(board, platform, "jiwy_firmware"))
    assert {"control_core.c", "service.c", "jiwy_app.c", "jiwy_pico.c", "control.c"} <= {file.name for file in sources}
    assert {file.name: said for file, command in sources.items() if (said := problems(command))} == {}
