# SPDX-License-Identifier: Apache-2.0
"""Velocity from the times of edges is right at low speed, at which there are 0 or 1 counts per cycle."""

from __future__ import annotations

import itertools
import struct

import pytest

from tests.doubles.rp2040.emulator import CLOCK

from .conftest import VELOCITY, Board, Config


def velocity(board: Board) -> float:
    return float(struct.unpack("<d", board.pico.read("velocities", 8))[0])


def read_each_millisecond(board: Board, times: int) -> list[float]:
    values = []
    for _ in range(times):
        board.read()
        values.append(velocity(board))
        board.pico.run(cycles=125_000 - board.pico.cycle % 125_000)
    return values


@pytest.mark.parametrize("direction", [1, -1])
@pytest.mark.parametrize("edges_per_second", [60, 333, 1500, 20_000, 1_000_000])
def test_constant_speed(board: Board, edges_per_second: int, direction: int) -> None:
    """After some edges the estimate is within 0.4 % in each read: the clock has a resolution of 1 us."""
    board.init(Config(10, 11, variant=VELOCITY))
    board.move(0, "constant", interval=CLOCK / edges_per_second, direction=direction)
    first = max(10, 3000 // edges_per_second)
    values = read_each_millisecond(board, first + 40)[first:]
    true = direction * edges_per_second
    assert all(abs(value / true - 1) < 0.004 for value in values), values


def test_at_rest_the_estimate_falls_to_0(board: Board) -> None:
    board.init(Config(10, 11, variant=VELOCITY))
    board.move(0, "constant", interval=CLOCK / 2000)
    assert read_each_millisecond(board, 20)[-1] == pytest.approx(2000, rel=0.004)
    board.rest()
    values = read_each_millisecond(board, 105)
    assert all(later <= earlier for earlier, later in itertools.pairwise(values))
    assert 30 < values[30] < 34  # no edge for 31 ms: at most one count in that time
    assert values[-1] == 0.0


def test_shaking_at_one_line_is_no_velocity(board: Board) -> None:
    board.init(Config(10, 11, variant=VELOCITY))
    start = board.pico.cycle + 1000
    board.move(0, "schedule", edges=[[start + 200_000 * k, 1 if k % 2 else -1] for k in range(60)])
    assert all(abs(value) < 1 for value in read_each_millisecond(board, 80))


def test_a_reversal_changes_the_sign(board: Board) -> None:
    board.init(Config(10, 11, variant=VELOCITY))
    board.move(0, "constant", interval=25_000)
    assert read_each_millisecond(board, 10)[-1] == pytest.approx(5000, rel=0.01)
    board.move(0, "constant", interval=25_000, direction=-1)
    assert read_each_millisecond(board, 10)[-1] == pytest.approx(-5000, rel=0.01)


def test_after_a_long_pause_counts_per_time(board: Board) -> None:
    """If the time between two reads is longer than the counter's range, the age of an edge is ambiguous."""
    board.init(Config(10, 11, variant=VELOCITY))
    board.move(0, "constant", interval=CLOCK / 3000)
    read_each_millisecond(board, 5)
    board.pico.run(milliseconds=20)
    board.read()
    assert velocity(board) == pytest.approx(3000, rel=0.02)
