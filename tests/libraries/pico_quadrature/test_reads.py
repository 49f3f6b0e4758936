# SPDX-License-Identifier: Apache-2.0
"""A read has a bounded time and a new value, reports a halted state machine, and does not use flash."""

from __future__ import annotations

from .conftest import HALTED, OK, PRESET, Board, Config

PIO0_CTRL = 0x50200000
# Bounds of epg_pico_quadrature_read() on a Cortex-M0+, in cycles, from docs/pico-quadrature.md.
LONGEST_READ = 200
LONGEST_FAILURE = 500


def test_a_read_takes_a_bounded_number_of_cycles(board: Board) -> None:
    board.init(Config(10, 11, state_machine=0))
    board.pico.call("watch_span", name="read", core=0, **{"from": "read_once", "to": "return"})
    for interval in (9, 10, 13, 100, 30_000):
        board.move(0, "constant", interval=interval)
        board.watch(1)
    board.rest()
    assert board.read() == board.true_counts()
    span = board.pico.call("span", name="read")
    cycles = [passage[1] for passage in span["passages"]]
    assert len(cycles) > 100
    assert max(cycles) <= LONGEST_READ
    assert span["flash_total"] == 0


def test_a_halted_state_machine_is_an_error_in_bounded_time(board: Board) -> None:
    board.init(Config(10, 11, state_machine=0))
    board.edges(0, [1] * 7)
    assert board.read() == [7]
    board.pico.call("write_register", address=PIO0_CTRL, value=0)
    board.pico.call("watch_span", name="read", core=0, **{"from": "read_once", "to": "return"})
    assert board.read() == [7]  # words that were already in the FIFO do not count as new
    assert board.errors() == [HALTED]
    assert board.read() == [7]
    assert board.errors() == [HALTED]
    cycles = [passage[1] for passage in board.pico.call("span", name="read")["passages"]]
    assert len(cycles) == 2
    assert max(cycles) <= LONGEST_FAILURE
    board.pico.call("write_register", address=PIO0_CTRL, value=1)
    assert board.read() == [7]
    assert board.errors() == [OK]


def test_a_read_is_not_older_than_its_call(board: Board) -> None:
    """The FIFO is full of words from after the last read; the read still shows an edge that came long after those."""
    board.init(Config(10, 11, state_machine=0))
    for n in range(20):
        board.pico.run(milliseconds=0.5)
        board.edges(0, [1])
        assert board.read() == [n + 1]


def test_preset_keeps_the_counts_since_the_last_read(board: Board) -> None:
    board.init(Config(10, 11, state_machine=0), Config(12, 13, state_machine=1))
    board.move(0, "random", seed=5, shortest=9, longest=40, reversal=0.3)
    board.move(1, "constant", interval=9.5)
    board.watch(0.5)
    before = board.positions()
    preset = -123_456_789_012
    board.pico.call("write", at="preset_to", hex=(preset % 2**64).to_bytes(8, "little").hex())
    board.ask(PRESET)
    board.watch(0.5)
    board.rest()
    after = board.read()
    counts = board.true_counts()
    assert [a - preset for a in after] == [count - b for count, b in zip(counts, before, strict=True)]
    assert counts[1] > 12_000
