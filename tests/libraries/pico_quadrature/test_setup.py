# SPDX-License-Identifier: Apache-2.0
"""Pins, direction, and the errors if a resource is not free."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from .conftest import (
    ANY,
    BLOCK,
    INSTRUCTION_MEMORY,
    OK,
    OTHERS,
    PIN_IN_USE,
    PINS,
    STATE_MACHINE,
    STOP,
    VELOCITY,
    Board,
    Config,
)


def test_any_pair_of_neighbours(board: Board) -> None:
    for low in range(29):
        assert board.init(Config(low, low + 1)) == [OK]
        board.edges(0, [1, 1, 1, -1, 1])
        assert board.read() == [3], f"GPIO {low}"
        board.ask(STOP)
        for pin in (low, low + 1):
            board.pico.call("drive", pin=pin, level=None)


@pytest.mark.parametrize(
    ("a", "b", "invert", "sign"), [(10, 11, False, 1), (11, 10, False, 1), (10, 11, True, -1), (11, 10, True, -1)]
)
def test_the_position_rises_when_a_leads_unless_inverted(board: Board, a: int, b: int, invert: bool, sign: int) -> None:
    assert board.init(Config(a, b, invert=invert)) == [OK]
    board.edges(0, [1] * 9)
    assert board.read() == [9 * sign]


@pytest.mark.parametrize("phase", range(4))
def test_counting_starts_at_0_wherever_the_shaft_stands(board: Board, phase: int) -> None:
    """The levels of the pins at the start do not count as an edge."""
    board.pico.call("encoder", name="before", a=10, b=11)
    for _ in range(phase):
        board.pico.call("move", name="before", kind="schedule", edges=[[board.pico.cycle + 10, 1]])
        board.pico.run(cycles=100)
    levels = [board.pico.call("pin", pin=pin)["level"] for pin in (10, 11)]
    assert levels == [[0, 0], [1, 0], [1, 1], [0, 1]][phase]
    board.pico.write_word("count", 1)
    for k, value in enumerate((10, 11, 0, 0, 0, 0, 0, 0)):
        board.pico.write_word("parameters", value, offset=4 * k)
    board.encoders = [Config(10, 11)]
    board.ask(1)
    assert board.read() == [0]
    board.pico.call("move", name="before", kind="schedule", edges=[[board.pico.cycle + 10, 1]])
    board.pico.run(cycles=100)
    assert board.read() == [1]


@pytest.mark.parametrize("pull", [0, 1, 2])
def test_pulls(board: Board, pull: int) -> None:
    assert board.init(Config(10, 11, pull=pull)) == [OK]
    for pin in (10, 11):
        state = board.pico.call("pin", pin=pin)
        assert (state["pullUp"], state["pullDown"]) == (pull == 1, pull == 2)
        assert state["function"] == 6  # PIO0
        assert not state["output"]


@pytest.mark.parametrize(
    ("config", "error"),
    [
        (Config(10, 12), PINS),
        (Config(10, 10), PINS),
        (Config(29, 30), PINS),
        (Config(31, 32), PINS),
        (Config(10, 11, block=2), BLOCK),
        (Config(10, 11, state_machine=4), STATE_MACHINE),
    ],
)
def test_what_cannot_be(board: Board, config: Config, error: int) -> None:
    assert board.init(config) == [error]
    # the failed calls kept no resource
    assert board.init(Config(10, 11), Config(12, 13), Config(14, 15), Config(16, 17)) == [OK] * 4


@pytest.mark.parametrize(
    ("others", "config", "error"),
    [
        (1, Config(10, 11, state_machine=2), STATE_MACHINE),
        (1, Config(10, 11, state_machine=ANY), OK),
        (2, Config(10, 11), INSTRUCTION_MEMORY),
        (2, Config(10, 11, block=1), OK),
        (4, Config(10, 11), PIN_IN_USE),
        (8, Config(10, 11), PIN_IN_USE),
        (8, Config(12, 13), OK),
    ],
)
def test_what_others_have_taken(board: Board, others: int, config: Config, error: int) -> None:
    board.pico.write_word("others", others)
    board.ask(OTHERS)
    assert board.init(config) == [error]


def test_five_in_one_block_and_one_pin_twice(board: Board) -> None:
    configs = [Config(2 * n + 2, 2 * n + 3) for n in range(5)]
    assert board.init(*configs) == [OK] * 4 + [STATE_MACHINE]
    board.ask(STOP)


def test_two_encoders_on_one_pin(board: Board) -> None:
    assert board.init(Config(10, 11), Config(11, 12), Config(13, 12)) == [OK, PIN_IN_USE, OK]


def test_a_block_has_one_variant(board: Board) -> None:
    assert board.init(Config(10, 11), Config(12, 13, variant=VELOCITY), Config(14, 15, block=1, variant=VELOCITY)) == [
        OK,
        INSTRUCTION_MEMORY,
        OK,
    ]


def test_stop_gives_everything_back(board: Board) -> None:
    pairs = [Config(2 * n + 2, 2 * n + 3) for n in range(4)]
    assert board.init(*pairs) == [OK] * 4
    board.ask(STOP)
    other = [Config(2 * n + 2, 2 * n + 3, variant=VELOCITY) for n in range(4)]
    assert board.init(*other) == [OK] * 4
    for n in range(4):
        board.edges(n, [1] * 5)
    assert board.read() == [5] * 4


def test_attach_to_what_the_caller_has_loaded_and_claimed(new_board: Callable[[], Board]) -> None:
    """Like a driver of another framework: with its own copy of the program and its own claim."""
    board = new_board()
    board.pico.write_word("others", 16)  # the program into PIO1, and state machine 1
    board.ask(OTHERS)
    assert board.init(Config(10, 11, block=1, state_machine=1, attach=True)) == [OK]
    board.edges(0, [1] * 6 + [-1] * 2)
    assert board.read() == [4]
    board.ask(STOP)
    assert board.init(Config(10, 11, block=1, state_machine=1)) == [STATE_MACHINE]  # still the caller's
    assert board.init(Config(10, 11, block=1, state_machine=ANY, attach=True)) == [STATE_MACHINE]
