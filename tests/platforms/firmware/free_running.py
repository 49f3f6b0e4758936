# SPDX-License-Identifier: Apache-2.0
"""``mps2/free_running.c`` on a board: its console, the line of its agent, and orders from the test."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from types import TracebackType
from typing import Any, ClassVar

from tests.doubles.mps2.qemu import Board
from tests.middlewares.client import Lines

ICOUNT = ("-icount", "shift=4,align=off,sleep=off")
"""An instruction takes 16 ns of the board's time, so that a busy computer delays the board as a whole, and not its
interrupts.  The programs do not sleep: the board's time passes about as fast as real time."""


@dataclass(frozen=True)
class State:
    """An answer to an order; ``free_running.c`` has the table."""

    time_us: int
    cycles: int
    missed: int
    overruns: int
    fault: int
    lateness_max: int
    alive: int
    unsafe: int
    result: int


class FreeRunning:
    """A board that runs, with a test at its lines."""

    LINES: ClassVar = ("console", "agent", "orders")
    """The use of each UART."""
    STATE: ClassVar[type[Any]] = State

    def __init__(self, machine: str, image: Path) -> None:
        self._board = Board(machine, image, uarts=len(self.LINES), options=ICOUNT)
        lines = dict(zip(self.LINES, self._board.lines, strict=True))
        self.agent = lines["agent"]
        """The connection of the agent's line."""
        self.console, self._orders = (Lines(lines[use].fileno(), lines[use].fileno()) for use in ("console", "orders"))

    def __enter__(self) -> Any:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, value: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._board.__exit__(kind, value, trace)

    def give(self, letter: str) -> None:
        """Gives an order that has no answer."""
        self._orders.send(letter)

    def order(self, letter: str) -> Any:
        """The state after an order."""
        self._orders.send(letter)
        (line,) = self._orders.until("")
        return self.STATE(*map(int, line.split()))

    def let_pass(self, milliseconds: int) -> Any:
        """The state after that much of the board's time, at least."""
        begin = state = self.order("?")
        while state.time_us - begin.time_us < 1000 * milliseconds:
            state = self.order("?")
        return state
