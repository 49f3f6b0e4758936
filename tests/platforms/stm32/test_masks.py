# SPDX-License-Identifier: Apache-2.0
"""How long the tick waits for code that masks interrupts, in JIWY's images on the emulated STM32H743."""

from __future__ import annotations

import re

import pytest

from tests.doubles.stm32.nvic import FIRST
from tests.doubles.toolchain import ROOT
from tests.platforms.stm32.agent import agent_of
from tests.platforms.stm32.images import PLATFORMS
from tests.platforms.stm32.jiwy import Jiwy
from tests.platforms.stm32.masks import Masks

PAGE = ROOT / "docs" / "boards" / "nucleo_h743zi.md"
STORE = "epg_sectors_read"
FAILURES = {"prvTaskExitError", "xPortStartScheduler"}
"""Functions of the kernel that mask interrupts only when they end the program."""


def documented() -> dict[str, int]:
    """The table of the page about the board."""
    table = PAGE.read_text(encoding="utf-8").partition("| function | mask | instructions |\n")[2].partition("\n\n")[0]
    rows = [line.split("|")[1:-1] for line in table.splitlines() if "`" in line]
    return {name: int(row[2]) for row in rows for name in re.findall(r"`(\w+)`", row[0])}


def with_console(platform: str) -> Masks:
    """Commands, and parameters that are saved and loaded."""
    jiwy = Jiwy(platform, masks=True)
    jiwy.chip.flash.erase_time = 0.002
    jiwy.run(20)
    for command in ("stats", "get", "disable", "save", "enable"):
        assert "error" not in jiwy.ask(command)
    assert jiwy.stats()["missed"] == "0"
    assert jiwy.masks is not None
    return jiwy.masks


def with_agent(platform: str) -> Masks:
    """A session with all topics."""
    jiwy = Jiwy(platform, "xrce", masks=True)
    agent = agent_of(jiwy)
    agent.run(50)
    agent.close()
    assert jiwy.masks is not None
    return jiwy.masks


@pytest.mark.parametrize("run", [with_console, with_agent])
@pytest.mark.parametrize("platform", PLATFORMS)
def test_masked_instructions_are_those_of_the_page(platform: str, run: object) -> None:
    masks = run(platform)  # type: ignore[operator]
    assert set(masks.longest_by_basepri.values()) <= {0}
    page = documented()
    names = {name for name in page if name != STORE} if platform == "freertos" else set()
    expected = names | ({STORE} if run is with_console else set())
    assert set(masks.longest) == expected
    assert masks.functions == names | {STORE} | (FAILURES if names else set())
    assert {name: count for name, count in masks.longest.items() if count > page[name]} == {}
    if platform == "freertos":
        assert min(masks.times, masks.times_by_basepri) > 200
    else:
        assert masks.times_by_basepri == 0, "nothing masks while the target runs"


def test_a_tick_that_basepri_masks_would_be_counted() -> None:
    """With a lower priority than the kernel's limit, the tick waits for whole critical sections."""
    jiwy = Jiwy("freertos", masks=True)
    jiwy.chip.processor.nvic.priorities[FIRST + jiwy.timer.kind.update] = 0xE0
    jiwy.run(5)
    assert jiwy.masks is not None
    assert max(jiwy.masks.longest.values()) > 10
