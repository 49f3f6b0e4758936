# SPDX-License-Identifier: Apache-2.0
"""The emulator's two cores: launch, mailboxes, spinlocks, dividers, events, interrupts, faults."""

from __future__ import annotations

import pytest

from .conftest import Board


def quotients(seed: int) -> int:
    """The sum that ``divide_many()`` must return."""
    total, x = 0, seed
    for n in range(1, 500):
        x = (x * 1664525 + 1013904223) % 2**32
        total += (x // n) ^ (x % n)
        signed = x - 2**32 if x >= 2**31 else x
        quotient = int(abs(signed) // n) * (-1 if signed > 0 else 1)  # towards zero; the divisor is -n
        total += (quotient % 2**32) ^ ((signed + n * quotient) % 2**32)
    return total % 2**32


def test_launch_mailboxes_and_spinlocks(board: Board) -> None:
    for _ in range(2):  # the second round follows a reset of core 1
        results = board.case("case_two_cores")
        assert results[:4] == [0, 101, 77, 1000]


def test_each_core_has_a_divider(board: Board) -> None:
    results = board.case("case_divide_on_both")
    assert results[:4] == [quotients(1), quotients(2), 2**32 - 1, 5]


def test_an_event_ends_one_wait(board: Board) -> None:
    registered, sent, seen = board.case("case_events")[:3]
    assert registered <= 2
    assert (registered + sent, seen) == (5, 5)


def test_an_interrupt_goes_to_the_core_that_enabled_it(board: Board) -> None:
    results = board.case("case_interrupt_of_core_1")
    assert results[8] == 0
    assert results[9] == 10  # wraps every 0.1 ms for 1.05 ms
    assert results[10] in (10, 11)


def test_an_interrupt_that_is_masked_ends_wfi(board: Board) -> None:
    assert board.case("case_masked_sleep")[:2] == [0, 1]


def test_priorities(board: Board) -> None:
    sequence, exception = board.case("case_nested")[:2]
    assert (sequence, exception) == (123456, 0)


CAUSES = {
    0: "unaligned write",
    1: "write to an address where nothing is",
    2: "breakpoint or undefined instruction",
    3: "breakpoint or undefined instruction",
    4: "execution of memory that is not executable",
    5: "branch to ARM code",
    6: "SVC at a priority that is too high",
    7: "write that the MPU forbids",
}


@pytest.mark.parametrize("core", [0, 1])
@pytest.mark.parametrize("kind", CAUSES)
def test_faults_reach_the_handler(board: Board, kind: int, core: int) -> None:
    board.begin("case_fault_of_core_1" if core else "case_fault", kind, 0)
    board.pico.run(milliseconds=2)
    [fault] = board.pico.call("faults")
    assert (fault["core"], fault["cause"], fault["lockup"]) == (core, CAUSES[kind], False)
    assert board.results()[:2] == [fault["pc"], core]
    assert board.pico.call("state")["cores"][core]["exception"] == 3


@pytest.mark.parametrize("core", [0, 1])
def test_a_fault_in_the_handler_locks_the_core_up(board: Board, core: int) -> None:
    board.begin("case_fault_of_core_1" if core else "case_fault", 2, 1)
    board.pico.run(milliseconds=2)
    faults = board.pico.call("faults")
    assert [fault["lockup"] for fault in faults] == [False, False, True]
    cores = board.pico.call("state")["cores"]
    assert [cores[0]["locked_up"], cores[1]["locked_up"]] == [core == 0, core == 1]


def test_spans_count_cycles_and_accesses_to_flash(board: Board) -> None:
    for name in ("case_from_flash", "case_from_ram"):
        board.pico.call("watch_span", name=name, core=0, **{"from": name, "to": "return"})
        assert board.case(name, 1)[0] == sum(n * n for n in range(100))
    flash, ram = (board.pico.call("span", name=name) for name in ("case_from_flash", "case_from_ram"))
    assert len(flash["passages"]) == len(ram["passages"]) == 1
    assert flash["flash_total"] > 300
    assert ram["flash_total"] == 0
    assert 400 < ram["passages"][0][1] < 2000
    symbol = board.pico.call("symbol", name="case_from_flash")
    assert all(symbol["address"] <= pc < symbol["address"] + symbol["size"] for _, pc, _ in flash["flash"])


def test_writes_to_memory_are_seen_with_their_pc(board: Board) -> None:
    board.pico.call("watch_memory", at="results", length=4)
    board.case("case_from_ram", 1)
    [[_, core, address, size, value, pc]] = board.pico.call("take", log="writes")
    symbol = board.pico.call("symbol", name="case_from_ram")
    assert (core, size, value) == (0, 4, 328350)
    assert address == board.pico.call("symbol", name="results")["address"]
    assert symbol["address"] <= pc < symbol["address"] + symbol["size"]
