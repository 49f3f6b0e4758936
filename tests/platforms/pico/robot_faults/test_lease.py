# SPDX-License-Identifier: Apache-2.0
"""The program that has enabled a Pico, or moves it by hand, fails: the motors are safe within 300 ms and a cycle.

The times are those of the board.  tests/connect/browser/test_failures.py lets the parts on the computer fail.
"""

from __future__ import annotations

import random
import re
from collections.abc import Callable, Iterator

import pytest

from epg.live.frames import Decoder, encode
from tests.doubles.rp2040.emulator import CYCLES_PER_MILLISECOND
from tests.platforms.pico.closed_loop.board import Board, image
from tests.platforms.pico.closed_loop.robot import AXES
from tests.platforms.pico.images import PLATFORMS, skip_unless_emulated

LEASE = 300
"""Milliseconds."""
PULSE = 100
"""Milliseconds."""


def jog(number: int) -> bytes:
    return encode(b"C\2jog pwm_pan 0.1 250 number=%d" % number)


class Program:
    """A program at the board's console."""

    def __init__(self, board: Board) -> None:
        self.board, self._decoder, self._draw = board, Decoder(), random.Random(7)
        self.answered = 0

    def run(self, milliseconds: int, *, moves: bool = False, garbage: int = 0) -> None:
        """Sends each number back, or prolongs the movement with it.  ``garbage`` bytes are in front of each frame."""
        for _ in range(milliseconds):
            self.board.pico.run(milliseconds=1)
            for part in self._decoder.feed(self.board.pico.receive_bytes()):
                if isinstance(part, bytes) and part.startswith(b"N"):
                    number = int.from_bytes(part[1:5], "little")
                    self._send(jog(number) if moves else encode(b"R" + part[1:]), garbage)
                    self.answered += 1

    def enable(self) -> None:
        """Enables the target on a lease; a program must name the newest stop that it knows."""
        self._send(encode(b"C\1stats"), 0)
        for _ in range(LEASE):
            self.board.pico.run(milliseconds=1)
            for part in self._decoder.feed(self.board.pico.receive_bytes()):
                found = re.search(rb" stop=(\S+)", part) if isinstance(part, bytes) else None
                if found:
                    self._send(encode(b"C\2enable leased after=" + found[1]), 0)
                    return
        raise AssertionError("the board did not tell its newest stop")

    def flood(self, milliseconds: int) -> None:
        """Sends only garbage, as much as USB carries, and understands nothing of what the board sends."""
        for _ in range(milliseconds):
            self.board.pico.send(self._draw.randbytes(1000))
            self.board.pico.run(milliseconds=1)

    def _send(self, frame: bytes, garbage: int) -> None:
        self.board.pico.send(self._draw.randbytes(garbage) + frame)


def falls_silent(program: Program) -> None:
    program.board.pico.run(milliseconds=2 * LEASE)


def closes_the_port(program: Program) -> None:
    program.board.pico.call("usb_open", open=False)
    program.board.pico.run(milliseconds=2 * LEASE)


def cable_out(program: Program) -> None:
    program.board.pico.call("usb_detach")
    program.board.pico.run(milliseconds=2 * LEASE)


def line_flooded(program: Program) -> None:
    program.flood(2 * LEASE)


@pytest.fixture(params=PLATFORMS)
def program(request: pytest.FixtureRequest) -> Iterator[Program]:
    skip_unless_emulated(request.param)
    with Board(image(request.param), {"pan": 2.5, "tilt": 1.3}) as board:
        board.ask("disable")
        yield Program(board)
        assert board.pico.call("faults") == []


@pytest.mark.parametrize("moves", [False, True], ids=["enabled", "moved"])
@pytest.mark.parametrize("failure", [falls_silent, closes_the_port, cable_out, line_flooded])
def test_the_motors_are_safe(program: Program, failure: Callable[[Program], None], moves: bool) -> None:
    pico = program.board.pico
    if moves:
        pico.send(jog(0))
    else:
        program.enable()
    # It homes for longer than a lease, also with garbage between the frames: damaged frames have no effect.
    program.run(LEASE + PULSE, moves=moves)
    program.run(LEASE, moves=moves, garbage=30)
    assert program.answered >= 6
    assert not program.board.is_safe(*AXES)
    pico.call("take", log="pins")
    begin = pico.cycle
    failure(program)
    assert program.board.is_safe(*AXES)
    edges = [cycle for cycle, *_ in pico.call("take", log="pins")]
    assert edges
    assert edges[-1] - begin <= (LEASE + 1) * CYCLES_PER_MILLISECOND
