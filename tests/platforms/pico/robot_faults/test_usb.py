# SPDX-License-Identifier: Apache-2.0
"""USB is unplugged during traffic or receives garbage: control is undisturbed, and the console recovers."""

from __future__ import annotations

import random
from collections.abc import Iterator

import pytest

from tests.platforms.pico.closed_loop.board import Board, image
from tests.platforms.pico.closed_loop.robot import AXES, PERIOD, WRAP_EXCEPTION
from tests.platforms.pico.images import PLATFORMS, skip_unless_emulated

PAN, TILT = AXES
SEED = 20250301


@pytest.fixture(params=PLATFORMS)
def board(request: pytest.FixtureRequest) -> Iterator[Board]:
    """Both axes hold a position that was set over the console."""
    skip_unless_emulated(request.param)
    with Board(image(request.param), {"pan": 0.12, "tilt": 0.12}) as made:
        made.home()
        made.ask("pan_subscriber=0.2 tilt_subscriber=0.2")
        made.pico.run(milliseconds=500)
        assert_holds(made)
        made.pico.call("watch_exceptions", numbers=[WRAP_EXCEPTION])
        yield made


def assert_holds(board: Board) -> None:
    assert board.motor("pan")["angle"] == pytest.approx(0.2, abs=3 * PAN.rad_per_count)
    assert board.motor("tilt")["angle"] == pytest.approx(0.2, abs=3 * TILT.rad_per_count)


def assert_no_tick_was_late(board: Board) -> None:
    entries = [cycle for cycle, _, _, entered in board.pico.call("take", log="exceptions") if entered]
    assert len(entries) > 500
    assert {(entry - entries[0]) % PERIOD for entry in entries} == {0}
    assert entries[-1] - entries[0] == (len(entries) - 1) * PERIOD


def test_pulled_while_packets_move_both_ways(board: Board) -> None:
    board.ask("watch")
    board.pico.call("usb_flood", text="ports\nstats\nhelp\n")
    for pause in (37.3, 11.9):
        board.pico.run(milliseconds=50)
        board.pico.call("usb_detach")
        board.pico.run(milliseconds=300 + pause)
        assert_holds(board)
        board.pico.call("usb_attach")
        state = board.pico.run(milliseconds=500, configured=True)
        assert state["usb"] == "configured"
    board.pico.call("usb_flood", on=False)
    board.pico.send("\n")
    board.pico.run(milliseconds=200)
    assert_no_tick_was_late(board)
    stats = board.stats()
    assert (stats["enabled"], stats["fault"], stats["missed"], stats["overruns"]) == ("1", "none", "0", "0")
    assert int(stats["reconnects"]) == 2
    assert board.pico.run(cycles=1)["resets"] == []
    board.ask("pan_subscriber=0.4 tilt_subscriber=0.2")
    board.pico.run(milliseconds=500)
    assert board.motor("pan")["angle"] == pytest.approx(0.4, abs=3 * PAN.rad_per_count)


def test_garbage(board: Board) -> None:
    """All 256 byte values at random, with many line ends and many beginnings of valid commands."""
    draw = random.Random(SEED)
    words = [
        b"pan_subscriber=",
        b"nan",
        b"1e999",
        b"set ",
        b"capture ",
        b"jog pwm_pan 1 9",
        b"watch ",
        b"get\n",
        b"\n",
        b"=",
    ]
    parts = [draw.choice(words) if draw.random() < 0.2 else draw.randbytes(draw.randint(1, 40)) for _ in range(700)]
    garbage = b"".join(parts).replace(b"pan_subscriber=", b"pan_subscriber=x")
    board.pico.send(garbage)
    board.pico.run(milliseconds=600)
    assert_holds(board)
    assert_no_tick_was_late(board)
    board.pico.send("\n")
    board.pico.run(milliseconds=300)
    stats = board.stats()
    assert (stats["enabled"], stats["fault"], stats["missed"], stats["overruns"]) == ("1", "none", "0", "0")
    assert board.pico.run(cycles=1)["resets"] == []
    assert board.pico.call("faults") == []
