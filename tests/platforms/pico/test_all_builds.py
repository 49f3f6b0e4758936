# SPDX-License-Identifier: Apache-2.0
"""Every image of the predefined configurations builds: JIWY and RELbot (a model in C++), by middleware."""

from __future__ import annotations

from itertools import combinations

import pytest

from tests.platforms.pico.compiled import own_sources, problems
from tests.platforms.pico.images import BOARDS, PLATFORMS, TARGETS, images, size_of, skip_unless_buildable

MIDDLEWARES = ("none", "console", "xrce", "xrce_console")
ROBOTS = ("jiwy", "relbot")
CELLS = [(*target, middleware, robot) for target in TARGETS for middleware in MIDDLEWARES for robot in ROBOTS]
PAIRWISE = [
    (board, platform, middleware, robot)
    for board, platform, middleware, robot in CELLS
    if (BOARDS.index(board) + PLATFORMS.index(platform) + MIDDLEWARES.index(middleware)) % 2 == 0
    and (BOARDS.index(board) + MIDDLEWARES.index(middleware) // 2 + ROBOTS.index(robot)) % 2 == 0
]
"""Each pair of two values, such as a board and a middleware, is in at least one of these."""


@pytest.mark.parametrize(("board", "platform", "middleware", "robot"), PAIRWISE)
def test_pairs(board: str, platform: str, middleware: str, robot: str) -> None:
    build_robot(board, platform, middleware, robot)


@pytest.mark.parametrize(("board", "platform", "middleware", "robot"), [cell for cell in CELLS if cell not in PAIRWISE])
def test_all_others(board: str, platform: str, middleware: str, robot: str) -> None:
    build_robot(board, platform, middleware, robot)


def test_every_pair_meets() -> None:
    for one, other in combinations(range(4), 2):
        assert {(cell[one], cell[other]) for cell in PAIRWISE} == {(cell[one], cell[other]) for cell in CELLS}


def build_robot(board: str, platform: str, middleware: str, robot: str) -> None:
    skip_unless_buildable(platform)
    folder = images(board, platform, f"{robot}_firmware", middleware=middleware)
    size = size_of(folder / f"{robot}_firmware.elf")
    print(f"{robot} {board} {platform} {middleware}: text {size.text}, data {size.data}, bss {size.bss}")
    assert (folder / f"{robot}_firmware.uf2").is_file()
    sources = own_sources(folder)
    assert {file.name: said for file, command in sources.items() if (said := problems(command))} == {}
