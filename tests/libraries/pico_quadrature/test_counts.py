# SPDX-License-Identifier: Apache-2.0
"""Counts are exact, with all state machines of both PIO blocks at once, with reversals, up to the documented rate."""

from __future__ import annotations

import pytest

from .conftest import COUNT, OK, VELOCITY, Board, Config

# Smallest distance of edges, in cycles, that the program counts exactly: one less than the header promises for silicon.
LIMIT = {COUNT: 9, VELOCITY: 11}


def eight(variant: int) -> list[Config]:
    """All state machines of both blocks, A below B and B below A, on 16 pins."""
    pairs = [(2, 3), (5, 4), (6, 7), (9, 8), (10, 11), (13, 12), (16, 17), (19, 18)]
    return [Config(a, b, block=n // 4, state_machine=n % 4, variant=variant) for n, (a, b) in enumerate(pairs)]


@pytest.mark.parametrize("variant", [COUNT, VELOCITY], ids=["count", "velocity"])
@pytest.mark.parametrize("seed", [1, 2])
def test_random_walks_with_reversals(board: Board, variant: int, seed: int) -> None:
    """Bursts at the highest rate, slow parts, a reversal after every tenth edge, with some hundred reads."""
    assert board.init(*eight(variant)) == [OK] * 8
    for n in range(8):
        board.move(n, "random", seed=100 * seed + n, shortest=LIMIT[variant], longest=60, reversal=0.1, burst=100)
    assert board.watch(5) > (100 if variant == COUNT else 10)
    board.rest()
    assert board.read() == board.true_counts()
    assert max(abs(count) for count in board.true_counts()) > 20
    assert board.pico.word("failures") == 0
    assert not any(board.pico.word("skipped", offset=4 * n) for n in range(8))


@pytest.mark.parametrize("variant", [COUNT, VELOCITY], ids=["count", "velocity"])
@pytest.mark.parametrize("reversal", [0.0, 0.02, 0.5])
def test_every_edge_at_the_limit_rate(board: Board, variant: int, reversal: float) -> None:
    """All edges have the smallest distance; the program still transfers words."""
    assert board.init(*eight(variant)) == [OK] * 8
    for n in range(8):
        limit = LIMIT[variant]
        board.move(n, "random", seed=n + 1, shortest=limit, longest=limit, reversal=reversal)
    board.watch(1.5 if variant == COUNT else 1.0)
    board.rest()
    assert board.read() == board.true_counts()
    assert board.pico.word("failures") == 0
    if reversal == 0.0:
        assert all(count > 8000 for count in board.true_counts())


@pytest.mark.parametrize("interval", [10, 12, 1000.5])
def test_constant_speed_both_ways(board: Board, interval: float) -> None:
    assert board.init(*eight(COUNT)) == [OK] * 8
    for n in range(8):
        board.move(n, "constant", interval=interval, direction=1 if n % 2 else -1)
    board.watch(1)
    board.rest()
    counts = board.true_counts()
    assert board.read() == counts
    assert all((count > 0) == (n % 2 == 1) for n, count in enumerate(counts))


@pytest.mark.parametrize("variant", [COUNT, VELOCITY], ids=["count", "velocity"])
def test_edges_beyond_the_limit_are_lost_and_noticed(board: Board, variant: int) -> None:
    """Edges closer than one sample lose counts, which also proves that these tests can fail."""
    assert board.init(*eight(variant)) == [OK] * 8
    for n in range(8):
        board.move(n, "random", seed=n + 1, shortest=4, longest=5, reversal=0.1)
    board.watch(1)
    board.rest()
    positions = board.read()
    assert all(position != count for position, count in zip(positions, board.true_counts(), strict=True))
    assert all(board.pico.word("skipped", offset=4 * n) > 0 for n in range(8))


@pytest.mark.parametrize("variant", [COUNT, VELOCITY], ids=["count", "velocity"])
def test_wraps_of_the_32_bit_count_are_followed(board: Board, variant: int) -> None:
    """The register is set near its limits; the position, 64 bits wide, continues."""
    board.init(Config(10, 11, state_machine=0, variant=variant))
    expected = 0
    for register in (0x70000000, 0xE0000000, 0xFFFFFFF0, 0x7FFFFFF0, 0xFFFFFFE0):
        # A jump of the register counts as motion: just below 2^31 counts, or modulo 2^16 with the velocity program.
        before = board.pico.call("pio", block=0, machine=0)["y"]
        board.pico.call("pio", block=0, machine=0, set={"y": register})
        jump = (register - before) % 2**32
        expected += jump if variant == COUNT else (jump + 2**15) % 2**16 - 2**15
        assert board.read() == [expected]
        board.edges(0, [1] * 40)
        expected += 40
        assert board.read() == [expected]
    if variant == COUNT:
        assert expected > 2**32
    board.edges(0, [-1] * 60)  # and back, over the 0 of the register
    assert board.read() == [expected - 60]


def test_the_zero_of_the_register_does_not_slow_the_decoder(board: Board) -> None:
    """Backwards through 0, where the decrement does not jump, at the highest rate."""
    board.init(Config(10, 11, state_machine=0))
    for _ in range(20):
        board.edges(0, [1] * 5 + [-1] * 10 + [1] * 5, apart=LIMIT[COUNT])
    assert board.read() == [0]
