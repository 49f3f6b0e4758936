# SPDX-License-Identifier: Apache-2.0
"""Commands at a console on USB act whether or not a terminal has set DTR, also in the instant in which it falls.

The checks of a board whose motors are driven from its start: JIWY looks for its end stops.
"""

from __future__ import annotations

import random
from collections.abc import Callable
from pathlib import Path
from types import TracebackType

from tests.doubles.rp2040.emulator import Emulator
from tests.platforms.pico.closed_loop.robot import AXES, connect

INSTANTS = 8
"""Number of phases of the host's frames, in each of which packets have other times."""

TURN = 4
"""Milliseconds in which a line has acted, or is answered so that the packet behind it is read: a packet that the host
sends late, a turn of the communication, and up to four control cycles."""


class Board:
    """The board after its start, which drives.  ``port``: the serial port of its console."""

    def __init__(self, elf: Path, port: int, usb: dict[str, object]) -> None:
        self.pico = Emulator(elf, usb={"seed": 3, "open": False} | usb)
        self._port = port
        connect(self.pico, {"pan": 1.2, "tilt": 0.7})
        self.pico.run(milliseconds=60)
        assert self.pico.call("usb")["state"] == "configured"
        assert self.driven()

    def __enter__(self) -> Board:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, value: BaseException | None, trace: TracebackType | None
    ) -> None:
        if kind is None:
            assert self.pico.call("faults") == []
            assert self.pico.run(cycles=1)["resets"] == []
        self.pico.close()

    def set_dtr(self, high: bool) -> None:
        self.pico.call("usb_open", open=high, port=self._port)

    def send(self, text: str) -> None:
        self.pico.send(text, port=self._port)

    def ask(self, line: str) -> str:
        self.send(f"{line}\n")
        return self.pico.run_until_text(f"ok {line}", milliseconds=200, port=self._port)

    def heard(self) -> str:
        return self.pico.receive(port=self._port)

    def run(self, milliseconds: float) -> None:
        self.pico.run(milliseconds=milliseconds)

    def run_until_driven(self) -> None:
        for _ in range(20):
            self.run(0.5)
            if self.driven():
                return
        raise AssertionError("it is not driven")

    def driven(self) -> bool:
        """True if a bridge has a duty or a direction."""
        return any(
            self.pico.call("pwm", slice=axis.slice)["a"] > 0
            or any(self.pico.call("pin", pin=pin)["level"] for pin in (axis.direction_a, axis.direction_b))
            for axis in AXES
        )


Make = Callable[..., Board]
"""Makes a board with these options of the host of USB."""


def check_without(make: Make) -> None:
    with make() as board:
        board.send("version\ndisable\n")
        board.run(10)
        assert not board.driven()
        board.run(50)
        assert not board.driven()
        assert board.heard() == ""
        board.set_dtr(True)
        board.run(10)
        said = board.ask("stats")
        assert said.startswith("ready "), "a program that opens the port does not get the answers for another one"
        assert "stat enabled=0" in said
        assert "ok disable" not in said


def check_falling(make: Make, *, first: str) -> None:
    """``first``: "disable" or "closing"; the other follows at once."""
    for instant in range(INSTANTS):
        with make(seed=1 + instant, phase=1000 * instant // INSTANTS) as board:
            board.set_dtr(True)
            board.run(5 + 0.136 * instant)
            if first == "closing":
                board.set_dtr(False)
            board.send("disable\n")
            if first == "disable":
                board.set_dtr(False)
            board.run(10)
            assert not board.driven(), instant


def check_waiting(make: Make) -> None:
    """One line is carried out per turn of the communication: most of them wait when DTR falls.

    The console reads 256 bytes ahead.  The stop is behind them.
    """
    with make() as board:
        board.set_dtr(True)
        board.run(5)
        board.send("version\n" * 60 + "disable\n")
        board.run(0.5)
        board.set_dtr(False)
        board.run(0.5)
        assert board.driven()
        board.run(100)
        assert not board.driven()


def check_half_line(make: Make) -> None:
    """The half line of a program that has gone does not hide the stop of the next one."""
    with make() as board:
        board.set_dtr(True)
        board.run(5)
        board.send("enab")
        board.run(5)
        board.set_dtr(False)
        board.run(5)
        board.set_dtr(True)
        board.run(5)
        assert board.driven()
        board.send("disable\n")
        board.run(10)
        assert not board.driven()


def check_race(make: Make, rounds: int) -> None:
    """The last of several lines is a stop, whatever DTR does meanwhile and afterwards.  A round costs 20 ms."""
    chance = random.Random(rounds)
    with make() as board:
        for number in range(rounds):
            dtr = chance.choice(["set", "cleared", "falls"])
            board.set_dtr(dtr != "cleared")
            board.run(chance.uniform(0.3, 1.3))
            board.send("enable\n")
            board.run_until_driven()
            lines = [*chance.choices(["enable\n", "disable\n"], k=chance.randint(1, 5)), "disable\n"]
            falls = chance.randrange(len(lines)) if dtr == "falls" else len(lines)
            for index, line in enumerate(lines):
                board.send(line)
                board.run(chance.choice([0.0, 0.0, chance.uniform(0, 0.3), chance.uniform(0, 3)]))
                if index == falls:
                    board.set_dtr(False)
            board.run(TURN * len(lines))
            for _ in range(4):
                assert not board.driven(), (number, dtr, lines, falls)
                board.run(chance.uniform(0.2, 2))
            board.heard()


CHECKS: dict[str, Callable[[Make], None]] = {
    "without DTR": check_without,
    "disable, then falling": lambda make: check_falling(make, first="disable"),
    "falling, then disable": lambda make: check_falling(make, first="closing"),
    "behind other lines": check_waiting,
    "after half a line": check_half_line,
}
