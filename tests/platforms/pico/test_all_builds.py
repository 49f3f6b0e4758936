# SPDX-License-Identifier: Apache-2.0
"""Every image that the predefined configurations give: JIWY and RELbot (a model in C++), by middleware."""

from __future__ import annotations

import pytest

from tests.platforms.pico.compiled import own_sources, problems
from tests.platforms.pico.images import TARGETS, images, size_of, skip_unless_buildable


@pytest.mark.parametrize("middleware", ["none", "console", "xrce", "xrce_console"])
@pytest.mark.parametrize(("board", "platform"), TARGETS)
def test_both_robots(board: str, platform: str, middleware: str) -> None:
    skip_unless_buildable(platform)
    folder = images(board, platform, "jiwy_firmware", "relbot_firmware", middleware=middleware)
    for robot in ("jiwy", "relbot"):
        size = size_of(folder / f"{robot}_firmware.elf")
        print(f"{robot} {board} {platform} {middleware}: text {size.text}, data {size.data}, bss {size.bss}")
        assert (folder / f"{robot}_firmware.uf2").is_file()
    sources = own_sources(folder)
    assert {file.name: said for file, command in sources.items() if (said := problems(command))} == {}
