# SPDX-License-Identifier: Apache-2.0
"""The emulator's watchdog, resets and flash."""

from __future__ import annotations

import pytest

from .conftest import Board


@pytest.mark.parametrize("feeds", [0, 3])
def test_a_starved_watchdog_resets_the_chip(board: Board, feeds: int) -> None:
    board.case("case_pins", 14, 1, 1, 0)
    starts = board.pico.word("starts")
    board.begin("case_watchdog", 5, feeds)
    begin = board.pico.cycle
    state = board.pico.run(milliseconds=5 + 2.5 * feeds + 1)
    [reset] = state["resets"]
    assert reset["cause"] == "watchdog"
    assert reset["cycle"] - begin == pytest.approx((5 + 2.5 * feeds) * 125_000, abs=3000)
    assert board.pico.call("pin", pin=14)["output"] is False  # pins float after a reset
    board.pico.run(milliseconds=5)
    assert board.pico.word("starts") == starts + 1
    assert board.results()[60:62] == [1, 1]
    watchdog = board.pico.call("watchdog")
    assert (watchdog["reason"], watchdog["scratch"][0]) == (1, 0x12345678)


def test_a_reboot_by_software(board: Board) -> None:
    board.begin("case_watchdog", 0, 0)
    state = board.pico.run(milliseconds=5)
    assert [reset["cause"] for reset in state["resets"]] == ["watchdog"]
    board.pico.run(milliseconds=5)
    assert board.results()[60:62] == [1, 0]  # reset by the watchdog, but on request: it did not time out


def test_the_run_pin_forgets_the_cause(board: Board) -> None:
    board.begin("case_watchdog", 5, 0)
    board.pico.run(milliseconds=10)
    board.pico.call("reset")
    board.pico.run(milliseconds=10)
    assert board.results()[60:62] == [0, 0]
    assert [reset["cause"] for reset in board.pico.call("state")["resets"]] == ["watchdog", "run pin"]


def test_flash_is_erased_and_programmed_while_core_1_waits(board: Board) -> None:
    status, microseconds, turns, different, erased = board.case("case_flash", 0, milliseconds=200)[:5]
    assert (status, different, erased) == (0, 0, 0xFFFFFFFF)
    assert 45_400 <= microseconds < 46_000
    assert turns < 2000  # rounds of core 1 in 45 ms: it was locked out meanwhile
    assert board.pico.call("faults") == []


def test_reading_flash_while_it_is_off_is_a_fault(board: Board) -> None:
    board.begin("case_flash", 1)
    board.pico.run(milliseconds=100)
    assert "flash is not readable now" in {fault["cause"] for fault in board.pico.call("faults")}
