# SPDX-License-Identifier: Apache-2.0
"""The time of memory in the emulator: the flash and its cache, and cores that wait for each other."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from .conftest import Board

WORD = 0x10010000
WAY = 8 * 1024  # bytes of flash that use each line of a way once
NOT_ALLOCATING, NOT_CACHED, NEITHER = 0x01000000, 0x02000000, 0x03000000
CORE_1_READS = 3 / (3 * 2 + 2)  # reads per cycle of the loop of core 1: three loads and a branch


@pytest.fixture
def slow(new_board: Callable[..., Board]) -> Board:
    return new_board(wait_states=True)


def hits(board: Board, addresses: list[int]) -> list[bool]:
    """Reads up to 8 words, and returns for each if the cache had it."""
    padded = [*addresses, *[addresses[-1]] * (8 - len(addresses))]
    times = board.case("case_read_times", *padded)
    transfer = board.pico.call("memory")["transfer"]
    least = min(times[:8])
    assert set(times[:8]) <= {least, least + transfer}
    found = [time == least for time in times[:8]]
    assert times[8] == 8 and times[9] == sum(found), "the cache's counters"
    return found[: len(addresses)]


def test_a_transfer_takes_the_time_of_the_clock_edges(slow: Board) -> None:
    """The second stage of the Pico: 8 edges of address, 4 to wait, 8 of data, at half of clk_sys; and the overhead."""
    assert slow.pico.call("memory")["transfer"] == (8 + 4 + 8) * 2 + 8


def test_lines_have_two_halves(slow: Board) -> None:
    assert hits(slow, [WORD, WORD, WORD + 4, WORD + 4, WORD, WORD + 8]) == [False, True, False, True, True, False]


def test_two_ways_keep_the_words_used_last(slow: Board) -> None:
    a, b, c = (WORD + n * WAY for n in range(3))
    assert hits(slow, [a, b, a, b, c, a, a, b]) == [False, False, True, True, False, False, True, False]


def test_the_windows_of_the_flash(slow: Board) -> None:
    addresses = [WORD + NOT_ALLOCATING, WORD, WORD + NOT_ALLOCATING, WORD + NOT_CACHED, WORD + NEITHER]
    assert hits(slow, addresses) == [False, False, True, False, False]
    assert hits(slow, [WORD + NOT_CACHED, WORD]) == [False, True]


def test_code_in_flash_waits_once(slow: Board, board: Board) -> None:
    """A second run of a function takes the time without wait states; the first one has a transfer for each word."""
    cycles = []
    for each in (slow, board):
        each.pico.call("watch_span", name="sum", core=0, **{"from": "case_from_flash", "to": "return"})
        for _ in range(2):
            each.case("case_from_flash", 3)
        cycles.append([passage[1] for passage in each.pico.call("span", name="sum")["passages"]])
    (cold, warm), (ideal, again) = cycles
    assert warm == ideal == again
    transfers, rest = divmod(cold - warm, slow.pico.call("memory")["transfer"])
    assert rest == 0 and 8 <= transfers <= 24


def test_cores_wait_for_each_other(slow: Board, board: Board) -> None:
    alone, timer, other_bank, same_bank, same_bridge, first = slow.case("case_contention")[:6]
    assert other_bank == alone
    assert 0 < same_bank - alone <= 1000 * CORE_1_READS * 2
    assert same_bridge > timer
    assert first == alone, "a core with a higher priority does not wait"
    ideal = board.case("case_contention")[:6]
    assert ideal == [alone, timer, alone, alone, timer, alone]


def test_a_core_that_must_not_read_flash(board: Board) -> None:
    board.pico.call("forbid_flash", core=1)
    board.case("case_from_flash", 3)
    assert board.pico.call("faults") == []
    board.pico.call("forbid_flash", core=0)
    board.begin("case_from_ram", 3)
    board.pico.run(milliseconds=1)
    fault = board.pico.call("faults")[0]
    assert fault["core"] == 0 and fault["cause"] == "access to flash by a core that must not have any"
