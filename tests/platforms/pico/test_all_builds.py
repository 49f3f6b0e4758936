# SPDX-License-Identifier: Apache-2.0
"""Every image of the predefined configurations builds: JIWY and RELbot (a model in C++), by middleware."""

from __future__ import annotations

from itertools import combinations

import pytest

from tests.platforms.pico.compiled import own_sources, problems
from tests.platforms.pico.images import BOARDS, PLATFORMS, TARGETS, images, size_of, skip_unless_buildable

MIDDLEWARES = ("none", "console", "xrce", "xrce_console")
CELLS = [(*target, middleware) for target in TARGETS for middleware in MIDDLEWARES]
PAIRWISE = [
    (board, platform, middleware)
    for board, platform, middleware in CELLS
    if (BOARDS.index(board) + PLATFORMS.index(platform) + MIDDLEWARES.index(middleware)) % 2 == 0
]
"""Each pair of board and platform, board and middleware, platform and middleware is in at least one of these."""


@pytest.mark.parametrize(("board", "platform", "middleware"), PAIRWISE)
def test_pairs(board: str, platform: str, middleware: str) -> None:
    build_both_robots(board, platform, middleware)


@pytest.mark.parametrize(("board", "platform", "middleware"), [cell for cell in CELLS if cell not in PAIRWISE])
def test_all_others(board: str, platform: str, middleware: str) -> None:
    build_both_robots(board, platform, middleware)


def test_every_pair_meets() -> None:
    for one, other in combinations(range(3), 2):
        assert {(cell[one], cell[other]) for cell in PAIRWISE} == {(cell[one], cell[other]) for cell in CELLS}


def build_both_robots(board: str, platform: str, middleware: str) -> None:
    skip_unless_buildable(platform)
    folder = images(board, platform, "jiwy_firmware", "relbot_firmware", middleware=middleware)
    for robot in ("jiwy", "relbot"):
        size = size_of(folder / f"{robot}_firmware.elf")
        print(f"{robot} {board} {platform} {middleware}: text {size.text}, data {size.data}, bss {size.bss}")
        assert (folder / f"{robot}_firmware.uf2").is_file()
    sources = own_sources(folder)
    assert {file.name: said for file, command in sources.items() if (said := problems(command))} == {}
